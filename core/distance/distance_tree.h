// The triangle nearest to a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/distance/triangle_pack.h"
#include "core/machine/simd.h"

namespace raycone {

// Packs of eight triangles, boxes of packs in nodes of eight, boxes of nodes in nodes of eight, and so on: triangles
// are split at medians along the longest axis until eight are left, so that every node but the last of a level is full.
// Embree's point queries are in single precision; this is in double throughout.
class DistanceTree {
 public:
  // The boxes of eight children; empty ones are infinitely far away. Child i of node n of a level is node 8 n + i of
  // the level before it; of the first level, it is a pack.
  struct alignas(64) Node {
    TrianglePack::Columns lower, upper;
    Node();
    void set(std::size_t child, const Box& box);
    [[nodiscard]] Box box() const;
  };
  using Level = std::vector<Node>;

  // `mesh` has at least one triangle, the largest coordinate of its triangles is in [1/2, 1]. Uses the threads that
  // ThreadLimit allows. Numbers do not depend on the level of SIMD, nor on threads.
  explicit DistanceTree(const TriangleMesh& mesh, SimdLevel level = SimdLevel::kBest);

  // The least of the triangles' squared distances (core/distance/triangle_distance.h) where that is not above `limit`,
  // nor beyond it by their error; else that of another triangle or infinity. A limit spares work. Thread-safe.
  [[nodiscard]] double squared_distance(const Vec3& p, double limit = std::numeric_limits<double>::infinity()) const {
    return search_(*this, p, limit);
  }

  // The triangle with that square, the first of several. Precondition: its square does not overflow. Thread-safe.
  [[nodiscard]] std::uint32_t nearest_triangle(const Vec3& p) const;

  // Sets `found` to the packs whose boxes' squared distance from `box` is below `limit`, or to any `most` of them.
  // Thread-safe.
  void find_packs(const Box& box, double limit, std::size_t most, std::vector<std::uint32_t>& found) const {
    find_packs_(*this, box, limit, most, found);
  }

  [[nodiscard]] std::span<const TrianglePack> packs() const { return {packs_.get(), pack_count_}; }
  // From the parents of packs to the root; none where there is one pack.
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] SimdLevel simd() const { return simd_; }

 private:
  std::vector<std::uint32_t> triangles_;  // of the mesh, eight to a pack
  std::size_t pack_count_;
  std::unique_ptr<TrianglePack[]> packs_;
  std::vector<Level> levels_;
  SimdLevel simd_;
  double (*search_)(const DistanceTree& tree, const Vec3& p, double limit);
  void (*find_packs_)(const DistanceTree& tree, const Box& box, double limit, std::size_t most,
                      std::vector<std::uint32_t>& found);
  std::uint32_t (*slots_at_)(const TrianglePack& pack, const Vec3& p, double square);
};

}  // namespace raycone
