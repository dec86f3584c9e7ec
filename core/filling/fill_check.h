// Whether a surface that closes the holes of a mesh is what is asked for.
#pragma once

#include "core/cells/edge_roots.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Whether the threshold is passed within a quarter of a voxel of nine tenths of the faces without a source, by their
// area, and within a voxel of 99 in 100, or of all but the area of a voxel's face, as their middles tell; faces thinner
// than 2^-6 voxels aside. `along`: of the mesh that the surface is of. Needs DefaultFloatingPoint. So does the next
// one. The same for any number of threads.
[[nodiscard]] bool is_along_threshold(const SurfaceMesh& surface, const RuleAlong& along, double voxel);

// What separates of the triangles of a mesh, with the rule holding on one side alone, and is farther than a quarter of
// a voxel from a surface; square units.
struct LostArea {
  double thin = 0.0;   // what is behind ends within half a voxel, as next to a sheet that hangs on the mesh
  double thick = 0.0;  // the rest
};

// Judged at points half a voxel apart.
[[nodiscard]] LostArea lost_area(const SurfaceMesh& surface, const TriangleMesh& mesh, const RuleAlong& along,
                                 double voxel);

// Whether that is little: what is thick no more than a twentieth of the area without a source, or a quarter of a
// voxel's face.
[[nodiscard]] bool keeps_what_separates(const SurfaceMesh& surface, const LostArea& lost, double voxel);

}  // namespace raycone
