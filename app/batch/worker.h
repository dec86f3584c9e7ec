// A worker process of a batch: raycone itself, started by the supervisor with a socket as its standard input.
#pragma once

#include <string>
#include <vector>

#include "app/process/exit_code.h"

namespace raycone {

// The command that makes a process a worker; it is no part of the command line that users see.
inline constexpr const char* kWorkerCommand = "batch-worker";

// Answers jobs until the socket is closed. `words`: the format and the options of BatchCommand. Signals that a terminal
// sends to all processes are left to the supervisor.
[[nodiscard]] ExitCode run_worker(const std::vector<std::string>& words);

}  // namespace raycone
