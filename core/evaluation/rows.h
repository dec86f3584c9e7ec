// The winding numbers of a block of a lattice, row by row.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/data/diagnostics.h"
#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate() or, where `rule` is given, apply_rule(), of a mesh that has triangles and a
// block that has samples. Not both diagnostics and a rule. Needs DefaultFloatingPoint.
Tally evaluate_block(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block,
                     std::span<double> values, std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics,
                     const Rule* rule);

}  // namespace raycone
