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
  double max_distance = 0.0;     // of vertices of faces with a source from the mesh, world units
  double hole_area = 0.0;        // of faces without a source
};

// Of triangles of the mesh: the part that is dropped, as judged at points half a cell's diagonal apart, at some 32 000
// of a triangle at most. It separates nothing, or is of parts thinner than the lattice sees.
struct DroppedArea {
  double area = 0.0;
  std::uint64_t samples = 0;  // how many of these points are dropped
  bool is_some = false;       // whether there is such area, even if world units make it 0 or infinite
};

// What a lattice is too coarse for.
struct ThinParts {
  double area = 0.0;       // of the mesh: dropped, though it separates or was to be thickened
  double of_all = 0.0;     // that area as a part of the mesh's
  std::uint64_t lost = 0;  // components of the mesh that are dropped as a whole, with such area
};

// Of the faces without a source.
[[nodiscard]] double hole_area(const SurfaceMesh& surface);

// Of each triangle of the mesh, whether faces with it as source have all of its area, but for rounding.
[[nodiscard]] std::vector<bool> held_triangles(const SurfaceMesh& surface, const TriangleMesh& mesh);

// `lattice`: around the surface.
[[nodiscard]] SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh,
                                              const Lattice& lattice);

[[nodiscard]] DroppedArea dropped_area(const TriangleMesh& mesh, DroppedSamples& dropped);

// Of a contour that drops area. A point of that separates where the rule differs a margin before and behind the
// triangle. Where the set has a thickness it was to be thickened, unless it is within the set. What is outside of the
// lattice does not count. Judged at the points that dropped_area is.
[[nodiscard]] ThinParts thin_parts(const TriangleMesh& mesh, const RuleAlong& rule, DroppedSamples& dropped);

}  // namespace raycone
