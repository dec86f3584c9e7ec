#pragma once

#include "app/command_spec.h"
#include "app/options.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] CommandSpec slice_spec();
[[nodiscard]] Command parse_slice(const Values& values);

}  // namespace raycone
