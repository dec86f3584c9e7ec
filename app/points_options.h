#pragma once

#include "app/command_spec.h"
#include "app/options.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] CommandSpec points_spec();
[[nodiscard]] Command parse_points(const Values& values);

}  // namespace raycone
