// All commands, each done by the folder that it belongs to.
#pragma once

#include "app/options/command.h"
#include "app/process/exit_code.h"

namespace raycone {

// Does what `command` says and returns how it ended; failures are exceptions (app/process/messages.h).
[[nodiscard]] ExitCode run_command(const Command& command);

}  // namespace raycone
