// The winding numbers of a block of a lattice, row by row.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/data/diagnostics.h"
#include "core/data/lattice.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate(), of a mesh that has triangles and a block that has samples. Needs
// DefaultFloatingPoint.
Tally evaluate_block(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block,
                     std::span<double> values, std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics);

}  // namespace raycone
