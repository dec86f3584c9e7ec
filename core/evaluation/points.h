// The winding numbers of points, in an order in which neighbours share triangles.
#pragma once

#include <span>

#include "core/evaluation/scaled_mesh.h"
#include "core/evaluation/value_outputs.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate(), or evaluate_unsettled(), of a mesh that has triangles. Needs
// DefaultFloatingPoint.
Tally evaluate_points(const ScaledMeshes& meshes, std::span<const Vec3> points, const ValueOutputs& out,
                      ScaledMesh::Settling settling = ScaledMesh::Settling::kDone);

}  // namespace raycone
