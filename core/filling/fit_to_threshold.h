// Faces without source, which close the holes of a mesh, moved to where its winding number says.
#pragma once

#include <cstddef>

#include "core/cells/edge_roots.h"
#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"

namespace raycone {

struct FitOptions {
  std::size_t most_faces = 0;                                    // without source
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of new vertices
};

// Divides the faces of a closed surface that have no source, until they are along where the winding number passes a
// threshold of the rule, and the surface separates the `inside` nodes from the others. New vertices are there, to
// 2^-34 of a voxel or so, or what their precision rounds; where that is on faces with a source, 2^-10 voxels behind
// these. Faces longer than a voxel are divided where their middle, or that of their longest side, is farther than 2^-6
// voxels from there. Nodes that no such face is near to get an octahedron around them. Edges of faces with a source
// stay as they are. Returns whether all nodes are on their sides then. The faces may pass through each other, and
// through others: the surface is the border of where its winding number is 1 or more. The same for any number of
// threads. Preconditions: as of closed_surface(), and `along` is of the rule and the mesh that the surface is of. Needs
// DefaultFloatingPoint.
[[nodiscard]] bool fit_to_threshold(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside,
                                    const FitOptions& options);

}  // namespace raycone
