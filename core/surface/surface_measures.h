// How far a surface is from the mesh that it was made of.
#pragma once

#include <cstdint>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/contour.h"

namespace raycone {

struct SurfaceMeasures {
  std::uint64_t components = 0;  // sets of faces that are joined through vertices
  double max_distance = 0.0;     // of vertices of faces with a source from the mesh, world units
  double hole_area = 0.0;        // of faces without a source
  // Of triangles of the mesh: the part that is farther from the surface than a cell's diagonal and the thickness of the
  // set, as judged at points two cells apart. It separates nothing, or is of parts thinner than the lattice sees.
  double dropped_area = 0.0;
};

[[nodiscard]] SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh,
                                              const Lattice& lattice, double thickness = 0.0);

}  // namespace raycone
