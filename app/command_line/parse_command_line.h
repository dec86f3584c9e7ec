// The command line, from words to a Command.
#pragma once

#include <string>
#include <vector>

#include "app/options/command.h"

namespace raycone {

// What --help prints: of `command`, of raycone itself where it is empty. Throws UsageError where there is none.
[[nodiscard]] std::string help_text(const std::string& command);

// `arguments` without the program's name. Throws UsageError.
[[nodiscard]] Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace raycone
