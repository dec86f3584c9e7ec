// Fewer triangles for the same surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/surface/contour.h"

namespace raycone {

// The surface with vertices pulled into neighbours along edges, wherever all faces around stay in the planes they are
// in
// (`input`'s, where they have a source in it), within `most`, world units. Triangles lower than `needle` do not count
// where a vertex moves by less: flat parts get larger faces, straight edges
// longer ones. Faces keep their order and sources; vertices keep their numbers, and some are no longer used. Those of
// `kept` stay. The same surface everywhere, topologically and within `most`; but where planes agree only up to
// rounding, faces that come as near to others may cross them.
struct MergedSurface {
  SurfaceMesh surface;
  std::vector<std::uint32_t> into;  // of each vertex, what it was pulled into; itself, where it stayed
};
[[nodiscard]] MergedSurface merge_planes(const SurfaceMesh& surface, const TriangleMesh& input,
                                         const std::vector<bool>& kept, double most, double needle);

}  // namespace raycone
