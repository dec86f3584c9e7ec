// `raycone lattice`: values on a regular lattice.
#pragma once

#include "app/options.h"
#include "app/report.h"
#include "app/run_steps.h"

namespace raycone {

// Evaluates and writes the lattice within `limits`; the output is complete when this returns. Warnings about the mesh
// are printed, the report is not. Throws UsageError, InputError, OutputError, LimitError, VerificationError.
[[nodiscard]] RunReport run_lattice(const LatticeCommand& command, const RunLimits& limits);

}  // namespace raycone
