// Winding numbers of a lattice's samples from its blocks, where that is cheaper than sample by sample.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "core/crossings/lattice_sums.h"
#include "core/data/lattice.h"
#include "core/evaluation/row_crossings.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/far/lattice_blocks.h"

namespace raycone {

// The coordinates of the whole lattice in the scale, if its samples are to be evaluated by mesh.blocks(): a matter of
// the mesh and the lattice alone.
[[nodiscard]] std::optional<LatticeAxes> axes_for_blocks(const ScaledMesh& mesh, const Lattice& lattice);

// Whether samples of a lattice that is not evaluated by blocks have the far field: a matter of the mesh and of how many
// samples were declared (Accuracy::samples), not of the part at hand.
[[nodiscard]] bool takes_far_field_on_lattice(const ScaledMesh& mesh);

// What the boundary term of the whole lattice takes on one thread of this machine, about, in seconds: caps and trees
// included, as evaluate_block() goes about it. Looks at blocks and far field, which takes their trees.
[[nodiscard]] double boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice);
// The same where it is summed directly. Takes a millisecond at most.
[[nodiscard]] double direct_boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice);

// The crossings of row j + k * block.counts[1] of a block: of its mesh, and of mesh.caps().
struct CrossingsOfRow {
  RowRuns mesh, caps;
};

// Sets the winding numbers of the samples of `part`, within the tolerance; x fastest. `axes`: those of its lattice.
// `crossings` is asked for each row, several times and by several threads; never where values do not depend on
// crossings. Those of a sample may be kept in its value: they are read before. A value that may be a half-integer,
// where rules have their thresholds, is as ScaledMesh::set_values() sets it. `done`, where given, grows by one per
// sample. Needs DefaultFloatingPoint.
void evaluate_blocks(const ScaledRows& part, const LatticeAxes& axes,
                     const std::function<CrossingsOfRow(std::size_t row)>& crossings, std::span<double> values,
                     std::atomic<std::uint64_t>* done);

}  // namespace raycone
