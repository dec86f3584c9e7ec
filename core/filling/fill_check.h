// Whether a surface that closes the holes of a mesh is what is asked for.
#pragma once

#include "core/cells/edge_roots.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Whether the faces without a source lie along a threshold of the rule, as their middles tell. It must pass within a
// quarter of a voxel of nine tenths of their area, and within a voxel of 99 in 100; as much as a voxel's face may be
// off in any case. Faces thinner than 2^-6 voxels do not count. `along`: of the mesh that the surface is of; `voxel`:
// its shortest side, world units. The same for any number of threads. Needs DefaultFloatingPoint.
[[nodiscard]] bool is_along_threshold(const SurfaceMesh& surface, const RuleAlong& along, double voxel);

// Area of a mesh that a surface has lost: the rule holds on one side alone there, and the surface is farther than a
// quarter of a voxel away. Square world units.
struct LostArea {
  double thin = 0.0;   // the set behind it ends within half a voxel, as next to a sheet that hangs on the mesh
  double thick = 0.0;  // the rest
};

// Judged at points half a voxel apart. The same for any number of threads. Needs DefaultFloatingPoint.
[[nodiscard]] LostArea lost_area(const SurfaceMesh& surface, const TriangleMesh& mesh, const RuleAlong& along,
                                 double voxel);

// Whether little is lost: no more thick area than a twentieth of the area without a source, or a quarter of a voxel's
// face.
[[nodiscard]] bool keeps_what_separates(const SurfaceMesh& surface, const LostArea& lost, double voxel);

}  // namespace raycone
