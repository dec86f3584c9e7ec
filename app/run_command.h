// The commands, each a straight line from its files to its results.
#pragma once

#include "app/options/options.h"
#include "app/process/exit_code.h"

namespace raycone {

// Does what `command` says and returns how it ended; failures are exceptions (report.h: report_current_exception).
[[nodiscard]] ExitCode run(const Command& command);

}  // namespace raycone
