// raycone surface: its options.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

[[nodiscard]] CommandSpec surface_spec();
[[nodiscard]] Command parse_surface(const Values& values);  // throws UsageError

}  // namespace raycone
