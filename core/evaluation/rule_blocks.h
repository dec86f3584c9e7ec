// On which side of a rule the samples of a lattice are, without the winding number of each.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// `values` are the crossings n of the samples of `rows`, x fastest; `cap_crossings` those of mesh.changes().caps. Turns
// each value into a number for which the rule holds where it holds for the winding number w: w itself, or that of a
// sample nearby but for the crossings between, where the two are certain to be on one side of each threshold
// (docs/method.md). A number that may be as near to a threshold as mesh.doubt() is w as ScaledMesh::set_values() sets
// it. `done`, where given, grows by one per sample. Needs DefaultFloatingPoint. Precondition: the mesh is open.
void apply_rule(const ScaledMesh& mesh, const LatticeRows& rows, const Rule& rule, std::span<double> values,
                std::span<const double> cap_crossings, std::atomic<std::uint64_t>* done);

}  // namespace raycone
