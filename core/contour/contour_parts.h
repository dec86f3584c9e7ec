// What contour() makes of some cells, and how it becomes one surface.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/cells/edge_points.h"
#include "core/contour/contour.h"

namespace raycone {

// What some cells contribute. Apexes are numbered from kFirstApex on, until all parts are joined.
struct ContourPart {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> sources;
  std::vector<Vec3> apexes;
  std::vector<std::uint64_t> tetrahedra;  // of the apexes: as ContouredSurface::tetrahedra
  std::vector<std::uint32_t> polygon_corners;
  struct Polygon {
    std::int32_t source;
    std::uint32_t size;
  };
  std::vector<Polygon> polygons;
  std::uint64_t full_triangles = 0;  // that tetrahedra would have in place of the polygons
};
inline constexpr std::uint32_t kFirstApex = 0x80000000;

// The points that no triangle has.
struct SparePoints {
  // Of edge points on diagonals of squares between two cells: whether the polygons of the cell above can do without,
  // and those of the cell below. The two cells have lists of their own, so that threads do not meet.
  std::vector<std::uint8_t> above, below;
  // Of edge points: whether they are within a cell of polygons.
  std::vector<std::uint8_t> within;
  // Of edge points (after settle_edges()) and of face points: whether they are spare.
  std::vector<std::uint8_t> edges, faces;

  // Makes `edges` of `within`, `above` and `below`: a point on a diagonal is spare where the polygons of both cells at
  // it can do without. Call it once.
  void settle_edges() {
    edges = std::exchange(within, {});
    for (std::size_t n = 0; n < edges.size(); ++n)
      edges[n] = static_cast<std::uint8_t>(edges[n] | (above[n] & below[n]));
    above = below = {};
  }
};

// Throws std::length_error where there are more points than have numbers.
void check_point_numbers(std::size_t points);

// Cuts the polygons of all parts into triangles, without the points that are spare. Returns how many triangles in
// planes that saves, as against tetrahedra.
std::uint64_t cut_polygons(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                           std::span<const Vec3> face_points, const SparePoints& spare);

// Makes one surface of all parts, which it empties. Its vertices are edge points, face points and apexes, in this
// order, but for those that are `spare`; null where none is. Throws std::length_error as contour() does.
[[nodiscard]] ContouredSurface joined(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                                      std::span<const Vec3> face_points, const SparePoints* spare);

}  // namespace raycone
