// All commands: what each accepts and how its values become a Command.
#pragma once

#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

struct CommandEntry {
  CommandSpec spec;
  Command (*parse)(const Values&);  // throws UsageError
};

// In the order of the help.
[[nodiscard]] const std::vector<CommandEntry>& commands();

// raycone itself: the options that need no command.
[[nodiscard]] const CommandSpec& program_spec();

}  // namespace raycone
