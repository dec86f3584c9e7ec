// How far a surface is from the mesh that it was made of.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/edge_roots.h"
#include "core/cells/surface_mesh.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/dropped_samples.h"

namespace raycone {

struct SurfaceMeasures {
  std::uint64_t components = 0;  // sets of faces that are joined through vertices
  double max_distance = 0.0;     // from the mesh to vertices of faces with a source, world units
  double hole_area = 0.0;        // of faces without a source, square world units
};

// The area of a mesh that is dropped, as judged at points half a cell's diagonal apart, at some 32 000 of a triangle at
// most. Dropped area separates nothing, or is of parts thinner than the lattice sees.
struct DroppedArea {
  double area = 0.0;          // square world units
  std::uint64_t samples = 0;  // how many of these points are dropped
  bool is_some = false;       // whether area is dropped, even if world units make it 0 or infinite
};

// Parts of a mesh that a lattice is too coarse for.
struct ThinParts {
  double area = 0.0;       // dropped, though it separates or was to be thickened; square world units
  double of_all = 0.0;     // as a fraction of the mesh's area
  std::uint64_t lost = 0;  // components of the mesh, with such area, that are dropped as a whole
};

// The area of the faces without a source, square world units.
[[nodiscard]] double hole_area(const SurfaceMesh& surface);

// Of each triangle of the mesh, whether the faces with it as their source have all of its area, but for rounding.
[[nodiscard]] std::vector<bool> held_triangles(const SurfaceMesh& surface, const TriangleMesh& mesh);

// `lattice`: around the surface. Uses the threads that ThreadLimit allows.
[[nodiscard]] SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh,
                                              const Lattice& lattice);

[[nodiscard]] DroppedArea dropped_area(const TriangleMesh& mesh, DroppedSamples& dropped);

// The thin parts of a mesh whose contour drops area. A dropped point separates where the rule differs a margin before
// and behind its triangle. Where the set has a thickness, a point was to be thickened unless it is within the set. What
// is outside of the lattice does not count. Judged at the points of dropped_area().
[[nodiscard]] ThinParts thin_parts(const TriangleMesh& mesh, const RuleAlong& rule, DroppedSamples& dropped);

}  // namespace raycone
