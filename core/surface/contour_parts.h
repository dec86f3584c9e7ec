// What contour() makes of some cells, and how it becomes one surface.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/contour.h"
#include "core/surface/edge_points.h"

namespace raycone {

// What some cells contribute. Apexes are numbered from kFirstApex on, until all parts are joined.
struct ContourPart {
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> sources;
  std::vector<Vec3> apexes;
  std::vector<std::uint64_t> tetrahedra;  // of them
  std::vector<std::uint32_t> polygon_corners;
  struct Polygon {
    std::int32_t source;
    std::uint32_t size;
  };
  std::vector<Polygon> polygons;
  std::uint64_t full_triangles = 0;  // that would be in their place
};
inline constexpr std::uint32_t kFirstApex = 0x80000000;

// The points that no triangle has.
struct SparePoints {
  // Of edges that are diagonals of cells' faces: the polygons of either cell, and whether both can do without.
  static constexpr unsigned kAbove = 1, kBelow = 2, kInline = 4, kWithinCell = 8;

  std::vector<std::uint8_t> edges, faces;

  // On any thread.
  void mark_edge(std::uint32_t edge, unsigned bits) {
    std::atomic_ref(edges[edge]).fetch_or(static_cast<std::uint8_t>(bits), std::memory_order_relaxed);
  }
  [[nodiscard]] static bool is_spare(std::uint8_t edge) {
    return edge == (kAbove | kBelow | kInline) || edge == kWithinCell;
  }
};

// Cuts the polygons of all parts into triangles, without the points that are spare. Returns how many triangles in
// planes there are less than tetrahedra would have.
std::uint64_t cut_polygons(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                           std::span<const Vec3> face_points, const SparePoints& spare);

// One surface of all parts, which it empties. Its vertices are edge points, face points and apexes, in this order.
[[nodiscard]] ContouredSurface joined(std::vector<ContourPart>& parts, std::span<const EdgePoint> edge_points,
                                      std::span<const Vec3> face_points);

}  // namespace raycone
