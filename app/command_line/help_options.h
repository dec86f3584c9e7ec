// raycone help: its operand.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

[[nodiscard]] CommandSpec help_spec();
[[nodiscard]] Command parse_help(const Values& values);

}  // namespace raycone
