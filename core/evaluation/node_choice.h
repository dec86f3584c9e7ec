// Whether interpolation pays in a block of samples whose sides are asked for, and between which nodes.
#pragma once

#include <optional>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/data/sample_box.h"
#include "core/evaluation/lattice_polynomial.h"

namespace raycone {

// The nodes for which there are fewest to evaluate together with the samples that are left undecided, about; none where
// interpolation does not pay, or is off by much. `derivatives` as NodeGrid takes them, some orders; `change`: from the
// sample in the middle of the box to others at most, turns.
[[nodiscard]] std::optional<NodeGrid> choose_nodes(const LatticeRows& rows, const SampleBox& box,
                                                   std::span<const double> derivatives, double change);

}  // namespace raycone
