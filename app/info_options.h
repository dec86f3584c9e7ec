#pragma once

#include "app/command_spec.h"
#include "app/options.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] CommandSpec info_spec();
[[nodiscard]] Command parse_info(const Values& values);

}  // namespace raycone
