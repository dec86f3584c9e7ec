// The points where sharp edges pass through the faces of a lattice's tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/cells/cell_creases.h"
#include "core/cells/edge_points.h"
#include "core/cells/surface_cells.h"
#include "core/cells/surface_in_cells.h"
#include "core/data/vec3.h"

namespace raycone {

// A face of a cell, as in kuhn::kFaces, as one number, which increases with the cell and then with the face.
inline constexpr std::uint64_t kFacesPerCell = 16;  // a power of two, more than a cell has
[[nodiscard]] constexpr std::uint64_t number_of_face(std::uint32_t cell, std::size_t face) {
  return kFacesPerCell * cell + face;
}
[[nodiscard]] constexpr std::uint32_t cell_of_face(std::uint64_t number) {
  return static_cast<std::uint32_t>(number / kFacesPerCell);
}
[[nodiscard]] constexpr std::size_t face_in_cell(std::uint64_t number) { return number % kFacesPerCell; }

// The two cells at a mixed face, by their places. Where the face is within a cell, twice that cell.
[[nodiscard]] std::array<std::uint32_t, 2> cells_at_face(const SurfaceCells& cells, std::uint32_t cell,
                                                         std::size_t face);

enum class PointsOfFaces : std::uint8_t {
  kOne,       // of all faces
  kSections,  // of faces between cells, not of those within one
};

// A point of a crease in a mixed face, where the planes at the face's two edge points disagree, or one of the points is
// in a hole: the point where the planes meet, if a crease is there; else the point of a crease that is farthest from
// the straight line between the two. None elsewhere. Precondition: `creases` has entered the cell.
[[nodiscard]] std::optional<Vec3> face_point(const SurfaceInCells& surface, std::uint32_t cell, std::size_t face,
                                             CreasesHere& creases);

class FacePoints {
 public:
  // The points that face_point() finds. With kSections, faces between cells may have other points. Where the planes do
  // not meet: all points of creases by which the mesh leads from one edge point to the other, if they go ahead all the
  // way; else the one that face_point() finds. Where planes meet on fine creases, or are one but for what single
  // precision rounds: points of these. Points are kept inside the face by the margin. They depend on the face, its two
  // edge points and the mesh alone, so that both its cells agree. Uses the threads that ThreadLimit allows.
  explicit FacePoints(const SurfaceInCells& surface, PointsOfFaces kind = PointsOfFaces::kOne);
  FacePoints() = default;
  // One point of each of these faces (number_of_face()), which increase.
  FacePoints(std::vector<std::uint64_t> faces, std::vector<Vec3> positions);

  [[nodiscard]] PointsOfFaces kind() const { return kind_; }
  // The face of each point.
  [[nodiscard]] const std::vector<std::uint64_t>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<Vec3>& positions() const { return positions_; }

  // Points whose numbers follow each other.
  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  // The points of a face of the cell, as in kuhn::kFaces, in order: from the edge point on the edge that is less by the
  // numbers of its corners, lower one first, to the other edge point. Thread-safe.
  [[nodiscard]] Range find(std::uint32_t cell, std::size_t face) const;
  // The plane that the surface is in between a point and the next one of the same face. Precondition: there is a next
  // one.
  [[nodiscard]] const EdgePoint& piece_behind(std::uint32_t point) const;

  // The faces with points that face_point() does not find, by number_of_face(), increasing.
  [[nodiscard]] const std::vector<std::uint64_t>& section_faces() const { return sections_; }
  // Leaves the points of such faces only where that pays: where one of the face's cells has a 1 in `cells_of_polygons`
  // (by place). The other faces get the point that face_point() finds.
  void keep_sections_at(const std::vector<std::uint8_t>& cells_of_polygons, const SurfaceInCells& surface);

  // A copy without the points of faces that have a point `dropped` (by number).
  [[nodiscard]] FacePoints without(const std::vector<bool>& dropped) const;

 private:
  struct Piece {
    std::uint32_t point;
    EdgePoint plane;
  };
  void add(std::uint64_t face, const Vec3& position) {
    faces_.push_back(face);
    positions_.push_back(position);
  }
  void add_section(const SurfaceInCells& surface, std::uint32_t cell, std::size_t face, CreasesHere& creases);
  // The points of one face: `begin` to `end` of others.
  void add_face(const FacePoints& of, std::size_t begin, std::size_t end);
  [[nodiscard]] std::size_t end_of_face(std::size_t point) const;
  void join(std::vector<FacePoints>& parts);
  void number_cells();

  PointsOfFaces kind_ = PointsOfFaces::kOne;
  std::vector<std::uint64_t> faces_;  // number_of_face() of each point; those of a face follow each other
  std::vector<Vec3> positions_;
  std::vector<std::uint64_t> sections_;
  std::vector<Piece> pieces_;                 // of the points that are not the last ones of their faces, increasing
  std::vector<std::uint32_t> first_of_cell_;  // up to the last cell that has any; one more at the end
  std::vector<std::uint16_t> faces_of_cell_;  // likewise, a bit for each
};

}  // namespace raycone
