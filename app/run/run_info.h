// `raycone info`: what meshes are, whether they are what is required, and what evaluation will cost.
#pragma once

#include "app/input/run_limits.h"
#include "app/options/info_command.h"
#include "app/process/exit_code.h"

namespace raycone {

// Prints the meshes as they are read, one in memory at a time. A mesh that cannot be read or exceeds a limit, and one
// that is not what is required, costs a line on standard error; the others go on. Returns the status of the worst of
// them. Throws UsageError, OutputError.
[[nodiscard]] ExitCode run_info(const InfoCommand& command, const RunLimits& limits);

}  // namespace raycone
