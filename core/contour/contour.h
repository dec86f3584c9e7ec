// The triangles between the points of a surface on the edges and faces of a lattice's tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cells/surface_in_cells.h"
#include "core/cells/surface_mesh.h"
#include "core/contour/face_points.h"

namespace raycone {

struct ContouredSurface {
  SurfaceMesh surface;
  // Of each apex: 6 * cell + the place in kuhn::kTetrahedra; or what kWholeCell or kFaceOfCell say.
  std::vector<std::uint64_t> tetrahedra;
  std::size_t first_apex = 0;  // among the vertices
  std::uint64_t fewer = 0;     // triangles in planes than there would be without polygons
};

enum class ContourCells : std::uint8_t {
  kTetrahedra,  // all of them are cut into tetrahedra
  kPolygons,    // not those that CellPolygons finds polygons in
};

// In the place of a tetrahedron, and these bits beside: a cell, of which the apex may be in any; or number_of_face(),
// of which it is the point.
inline constexpr std::uint64_t kWholeCell = std::uint64_t{1} << 63, kFaceOfCell = std::uint64_t{1} << 62;

// In each tetrahedron with nodes of both kinds, the points on its edges and faces form a loop of straight lines.
// Without face points the loop is filled by one or two triangles, else by a cone from a point within the tetrahedron:
// an end of a crease, else where a crease leaves the tetrahedron through the face with nodes of one kind, else another
// point of a crease. Where there are none, it is the point where all planes meet, or the mean of the points. Vertices
// are first the edge points in their order, then the face points, then those apexes; without points that no triangle
// has. Where `face_points` are sections, points of faces within cells are looked for where they are needed, and are
// among the apexes. Fronts look from inside to outside. The same for any number of threads. docs/method.md, "Surfaces",
// shows that the triangles meet nowhere but in shared vertices and edges.
[[nodiscard]] ContouredSurface contour(const SurfaceInCells& surface, const FacePoints& face_points,
                                       ContourCells kind = ContourCells::kTetrahedra);

}  // namespace raycone
