// Where faces of a surface are, as seen from the triangles of the mesh that they are of.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// In the plane of its source, or over a hole; off that plane; or so much turned against it, too, that it may lead
// across a sharp edge. Fine tessellations are off, and hardly turned.
enum class Placed : std::uint8_t { kInPlane, kOff, kAcross };

// Of each face. `normals`: of `input`; `off`: how far corners may be from a plane that they are in, world units.
[[nodiscard]] std::vector<Placed> placements(const SurfaceMesh& surface, const TriangleMesh& input,
                                             const TriangleNormals& normals, double off);

// Whether it is planes that the mesh is made of: three of four faces are in one. Of CAD parts 75 to 99 per cent of the
// faces are, of scans less than 70. `fewer`: faces in planes than there would be without polygons, which count.
[[nodiscard]] bool are_mostly_in_planes(const std::vector<Placed>& placements, std::uint64_t fewer);

}  // namespace raycone
