// The winding numbers of points, in an order in which neighbours share triangles.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "core/data/diagnostics.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// As WindingNumberEvaluator::evaluate(), or evaluate_unsettled(), of a mesh that has triangles. Needs
// DefaultFloatingPoint.
Tally evaluate_points(const ScaledMeshes& meshes, std::span<const Vec3> points, std::span<double> values,
                      std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics,
                      ScaledMesh::Settling settling = ScaledMesh::Settling::kDone);

}  // namespace raycone
