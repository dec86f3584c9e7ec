// `raycone points`: values at given points.
#pragma once

#include "app/input/run_limits.h"
#include "app/options/points_command.h"
#include "app/report/run_report.h"

namespace raycone {

// Evaluates the points and writes their values within `limits`; the output is complete when this returns. Warnings
// about the mesh are printed, the report is not. Throws UsageError, InputError, OutputError, LimitError,
// VerificationError.
[[nodiscard]] RunReport run_points(const PointsCommand& command, const RunLimits& limits);

}  // namespace raycone
