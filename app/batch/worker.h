// A worker process of a batch: raycone itself, started by the supervisor with a socket as its standard input.
#pragma once

#include "app/process/exit_code.h"

namespace raycone {

// The command that makes a process a worker; it is no part of the command line that users see.
inline constexpr const char* kWorkerCommand = "batch-worker";

// Does each MeshCommand that it receives, and answers with a JobResult, until the socket is closed. Signals that a
// terminal sends to all processes are left to the supervisor.
[[nodiscard]] ExitCode run_worker();

}  // namespace raycone
