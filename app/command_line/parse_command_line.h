// The command line, from words to a Command.
#pragma once

#include <string>
#include <vector>

#include "app/options/command.h"

namespace raycone {

// `arguments` without the program's name. Throws UsageError.
[[nodiscard]] Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace raycone
