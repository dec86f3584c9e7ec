// The commands, each a straight line from its files to its results.
#pragma once

#include "app/options.h"

namespace raycone {

// Does what `command` says; how it ended is the exception thrown, if any (report.h: report_current_exception).
void run(const Command& command);

}  // namespace raycone
