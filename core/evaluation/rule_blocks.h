// On which side of a rule the samples of a lattice are, without the winding number of each.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// Sets each side to 1 where the rule holds and to 0 where it does not; x fastest. `crossings` are the finished runs of
// the mesh, `cap_crossings` those of mesh.caps(), both of `rows`, and both without crossings where values depend on
// none. Blocks of samples that are certain to be on one side of each threshold, but for the crossings between them, are
// evaluated at one sample, others by rough sums where there are any (docs/method.md). `done`, where given, grows by one
// per sample. Needs DefaultFloatingPoint. Precondition: the mesh is open and in scale; if its values depend on no
// crossings, it has blocks that are sound.
void set_sides(const ScaledMesh& mesh, const LatticeRows& rows, const Rule& rule, const LatticeSums& crossings,
               const LatticeSums& cap_crossings, std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done);

}  // namespace raycone
