// `raycone surface`: a closed mesh of the set where a rule holds.
#pragma once

#include "app/input/run_limits.h"
#include "app/options/surface_command.h"
#include "app/report/run_report.h"

namespace raycone {

// Makes, checks and writes the surface within `limits`; the output is complete when this returns. Warnings about the
// mesh are printed, the report is not. Throws UsageError, InputError (nothing is inside, or the inside reaches the
// lattice's border), OutputError, LimitError, SurfaceFailure.
[[nodiscard]] RunReport run_surface(const SurfaceCommand& command, const RunLimits& limits);

}  // namespace raycone
