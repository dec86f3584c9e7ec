// Faces without source, which close the holes of a mesh, moved to where its winding number says.
#pragma once

#include <cstddef>

#include "core/cells/edge_roots.h"
#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"

namespace raycone {

struct FitOptions {
  std::size_t most_faces = 0;                                    // of faces without source, as a limit
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of new vertices
};

// Divides the faces without source of a closed surface, until they lie along a threshold of the rule and the surface
// separates the `inside` nodes from the others. New vertices lie on the threshold, to 2^-34 of a voxel or so, or to
// what their precision rounds; where it is on faces with a source, 2^-10 voxels behind these. A face is divided where
// its middle, or that of its longest side, is farther from the threshold than 2^-6 voxels or, of faces no longer than a
// voxel, 2^-3. A node on the wrong side that no such face is near to gets an octahedron around it. Edges of faces with
// a source stay as they are.
// Returns whether all nodes are on their sides then; false also where that would take too many faces. The faces may
// pass through each other, and through others: the border of where the winding number of `surface` is 1 or more is what
// is wanted. The same for any number of threads. Preconditions: as of closed_surface(), and `along` is of the rule and
// of the mesh that the surface is of. Needs DefaultFloatingPoint.
[[nodiscard]] bool fit_to_threshold(SurfaceMesh& surface, const RuleAlong& along, const NodeSet& inside,
                                    const FitOptions& options);

}  // namespace raycone
