// What was asked for, as files keep it.
#pragma once

#include <string>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"

namespace raycone {

// The options that results depend on, "--name=value" or "--name", by name: not those that say where results go, what a
// run may use or what it prints, and not what would hold anyway. Files are named without their directories. `known`:
// the command's.
[[nodiscard]] std::vector<std::string> given_options(const Values& values, const OptionNames& known);

}  // namespace raycone
