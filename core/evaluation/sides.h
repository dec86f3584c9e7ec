// On which side of a rule the samples of a block of a lattice are.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate_sides(), of a mesh that has triangles and a block that has samples. Needs
// DefaultFloatingPoint.
Tally evaluate_block_sides(const ScaledMeshes& meshes, const Rule& rule, const Lattice& lattice,
                           const LatticeBlock& block, std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done);

}  // namespace raycone
