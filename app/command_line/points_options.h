// raycone points: its options.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

[[nodiscard]] CommandSpec points_spec();
[[nodiscard]] Command parse_points(const Values& values);  // throws UsageError

}  // namespace raycone
