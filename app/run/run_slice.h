// `raycone slice`: a picture of one cross-section.
#pragma once

#include "app/input/run_limits.h"
#include "app/options/slice_command.h"
#include "app/report/run_report.h"

namespace raycone {

// Evaluates the pixels and writes picture and numbers within `limits`; the files are complete when this returns.
// Warnings about the mesh are printed, the report is not. Throws UsageError, InputError, OutputError, LimitError.
[[nodiscard]] RunReport run_slice(const SliceCommand& command, const RunLimits& limits);

}  // namespace raycone
