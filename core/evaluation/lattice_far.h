// Winding numbers of a lattice's samples from its blocks, where that is cheaper than sample by sample.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/data/lattice.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/far/lattice_blocks.h"

namespace raycone {

// The coordinates of the whole lattice in the scale, if its samples are to be evaluated by mesh.blocks(): a matter of
// the mesh and the lattice alone.
[[nodiscard]] std::optional<LatticeAxes> axes_for_blocks(const ScaledMesh& mesh, const Lattice& lattice);

// What the boundary term of the whole lattice takes on one thread, about, caps and trees included; as evaluate_block()
// goes about it. Seconds of a machine that docs/benchmarks.md describes. `by_far_field`: whether blocks and far field
// are looked at, which takes their trees; without, what a direct sum takes.
[[nodiscard]] double boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice, bool by_far_field);

// `values` are the crossings of the samples of `block`, x fastest, and `cap_crossings` those of mesh.blocks().caps; of
// no account where values do not depend on crossings. Turns each into the winding number within the tolerance. A value
// that may be a half-integer, where rules have their thresholds, is as ScaledMesh::set_values() sets it. `done`, where
// given, grows by one per sample. Needs DefaultFloatingPoint.
void evaluate_blocks(const ScaledMesh& mesh, const LatticeAxes& axes, const Lattice& lattice, const LatticeBlock& block,
                     std::span<double> values, std::span<const double> cap_crossings, std::atomic<std::uint64_t>* done);

}  // namespace raycone
