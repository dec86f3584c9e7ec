// The triangle nearest to a point.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Boxes of triangles in nodes of eight, boxes of nodes in nodes of eight, and so on: triangles are split at medians
// along the longest axis until eight are left, so that every node but the last of a level is full. Embree's point
// queries are in single precision; this is in double throughout.
class DistanceTree {
 public:
  // `mesh` has at least one triangle and outlives the tree; the largest coordinate of its triangles is in [1/2, 1].
  explicit DistanceTree(const TriangleMesh& mesh);

  // The least of the triangles' squared distances (core/distance/triangle_distance.h) where that is not above `limit`,
  // nor beyond it by their error; else a larger number or infinity. A limit spares work. Thread-safe.
  [[nodiscard]] double squared_distance(const Vec3& p, double limit = std::numeric_limits<double>::infinity()) const;

 private:
  static constexpr std::size_t kWidth = 8;

  // The boxes of eight children; empty ones are infinitely far away.
  struct alignas(64) Node {
    std::array<std::array<double, kWidth>, 3> lower, upper;  // by axis
    Node();
    void set(std::size_t child, const Box& box);
    [[nodiscard]] Box box() const;
    // Squared distances from p, but for rounding.
    [[nodiscard]] std::array<double, kWidth> bounds(const Vec3& p) const;
  };
  // Child i of node n of a level is node 8 n + i of the level before it; of the first level, triangle 8 n + i of
  // triangles_.
  using Level = std::vector<Node>;

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Level> levels_;
};

}  // namespace raycone
