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
  // Of each apex: 6 * cell + the place of its tetrahedron in kuhn::kTetrahedra; or see kWholeCell and kFaceOfCell.
  std::vector<std::uint64_t> tetrahedra;
  std::size_t first_apex = 0;  // among the vertices; the others follow
  std::uint64_t fewer = 0;     // how many triangles in planes polygons have saved
};

enum class ContourCells : std::uint8_t {
  kTetrahedra,  // all of them are cut into tetrahedra
  kPolygons,    // not those that CellPolygons finds polygons in
};

// What an apex of ContouredSurface belongs to where it is of no tetrahedron: with kWholeCell set, the other bits are a
// cell, and the apex may be anywhere in it; with kFaceOfCell, they are number_of_face(), and the apex is the point of
// that face.
inline constexpr std::uint64_t kWholeCell = std::uint64_t{1} << 63, kFaceOfCell = std::uint64_t{1} << 62;

// In each mixed tetrahedron, the points on its edges and faces form a loop of straight lines. Without face points the
// loop is filled by one or two triangles; with them, by a cone from a point within the tetrahedron: the end of a
// crease; else where a crease leaves the tetrahedron through the face with nodes of one kind; else another point of a
// crease. Where there are no creases, it is the point where all planes meet, or the mean of the points.
// Vertices are first the edge points in their order, then the face points, then the apexes (those points of tetrahedra
// and cells); points that no triangle has are left out. Where `face_points` are sections, points of faces within cells
// are looked for where they are needed, and are among the apexes. Fronts look from inside to outside. Throws
// std::length_error for more than 2^31 vertices or kMaxTriangles faces. Uses the threads that ThreadLimit allows; the
// same for any number of them. docs/method.md, "Surfaces", shows that the triangles meet nowhere but in shared vertices
// and edges.
[[nodiscard]] ContouredSurface contour(const SurfaceInCells& surface, const FacePoints& face_points,
                                       ContourCells kind = ContourCells::kTetrahedra);

}  // namespace raycone
