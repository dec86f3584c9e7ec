// The winding numbers of a block of a lattice, row by row.
#pragma once

#include "core/data/lattice.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/evaluation/value_outputs.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate(), of a mesh that has triangles and a block that has samples. Needs
// DefaultFloatingPoint.
Tally evaluate_block(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block,
                     const ValueOutputs& out);

}  // namespace raycone
