// `raycone lattice`: values on a regular lattice.
#pragma once

#include <functional>
#include <span>

#include "app/input/run_limits.h"
#include "app/options/lattice_command.h"
#include "app/report/run_report.h"
#include "core/data/placed_lattice.h"

namespace raycone {

// Called for each slab, in turn, with its samples as FieldSamples::shown() has them: x fastest, then y, then z.
using SlabObserver = std::function<void(const PlacedLattice&, const LatticeBlock&, std::span<const double>)>;

// Evaluates and writes the lattice within `limits`; the output is complete when this returns. Warnings about the mesh
// are printed, the report is not. Throws UsageError, InputError, OutputError, LimitError, VerificationError.
[[nodiscard]] RunReport run_lattice(const LatticeCommand& command, const RunLimits& limits,
                                    const SlabObserver& observe = {});

}  // namespace raycone
