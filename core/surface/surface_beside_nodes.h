// Surfaces of meshes whose planes lead through nodes of the lattice.
//
// Rounding has such nodes on either side of the plane, and faces would have to go around each. A lattice that is moved
// by a part of a voxel has its nodes off the planes. Where planes are all there is, its surface is that of the lattice
// given, too: if its faces are between corners of the mesh, they have each node on the right side, exactly.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Whether three quarters of a surface's area, or more, is in the planes of its sources within `off` (world units), as
// that of CAD parts is.
[[nodiscard]] bool is_of_planes(const SurfaceMesh& surface, const TriangleMesh& input, double off);

// Lengths are world units.
struct BesideNodesLimits {
  double to_corners = 0.0;  // how far points may be moved to corners, and into level planes, of the mesh
  double off = 0.0;         // how far points of the lattice's edges may be from the surface
  std::size_t faces = 0;    // a surface with as many is of no use
  CoordinatePrecision precision = CoordinatePrecision::kDouble;
};

// Makes the merged surface of a lattice, if there is one without faults.
using MergedSurface = std::function<std::optional<SurfaceMesh>(const Lattice&)>;

// Tries up to six moved lattices. Returns the first surface of `input` that has no faults (faults_of()) as the surface
// of `inside`, and has `points`, those of the lattice's edges, on it. None where a surface has as many faces as
// `limits.faces`, or a point is off it, or no lattice will do.
[[nodiscard]] std::optional<SurfaceMesh> surface_beside_nodes(const TriangleMesh& input, const NodeSet& inside,
                                                              std::span<const Vec3> points,
                                                              const BesideNodesLimits& limits,
                                                              const MergedSurface& merged_surface);

}  // namespace raycone
