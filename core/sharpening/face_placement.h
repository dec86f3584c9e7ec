// Where faces of a surface are, as seen from the triangles of the mesh that they are of.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/surface_mesh.h"
#include "core/cells/triangle_normals.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Where a face is: in the plane of its source, or without a source; off that plane; or off it and turned against it by
// more than 3 degrees, so that it may lead across a sharp edge. Faces of fine tessellations are mostly off, and hardly
// turned.
enum class Placed : std::uint8_t { kInPlane, kOff, kAcross };

// Per face of the surface. `normals`: of `input`; `off`: how far corners of a face in a plane may be from it, world
// units.
[[nodiscard]] std::vector<Placed> placements(const SurfaceMesh& surface, const TriangleMesh& input,
                                             const TriangleNormals& normals, double off);

// Whether the mesh is made of planes: three of four faces are in one. Of CAD parts 75 to 99 per cent of the faces are,
// of scans less than 70. `fewer`: how many faces in planes there are less than without polygons
// (ContouredSurface::fewer); they count, too.
[[nodiscard]] bool are_mostly_in_planes(const std::vector<Placed>& placements, std::uint64_t fewer);

}  // namespace raycone
