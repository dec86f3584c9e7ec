// Candidate triangles of rays along +x, by a packed tree over the triangles' projections along the ray.
#pragma once

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"

namespace raycone {

// Triangles in order of size class, then along a Z-curve of their centres, packed into nodes of eight, these
// again into nodes of eight, and so on (after Kamel and Faloutsos, "On Packing R-trees", 1993). A ray is a point of the
// projection, so a node is a comparison of eight boxes with it; boxes are rounded outward, so that no candidate is
// missed.
class ProjectedTree {
 public:
  // `mesh` has at least one triangle.
  explicit ProjectedTree(const TriangleMesh& mesh);

  // Calls visit(i, triangle) for each ray {origins[i] + t x, t >= 0} and each triangle whose closed box it meets, once,
  // and possibly for others, in an order of no meaning. At most kGroup origins; close ones share a descent.
  // Thread-safe.
  static constexpr std::size_t kGroup = 8;
  template <class Visit>
  void find(std::span<const Vec3> origins, const Visit& visit) const;

  // Where a query lies along the curve, in [0, kPlaces): queries of neighbouring places share candidates.
  static constexpr std::size_t kPlaces = std::size_t{1} << 16;
  [[nodiscard]] std::size_t place(const Vec3& origin) const;

 private:
  static constexpr std::size_t kWidth = 8;

  // Rays by their origins, in float.
  struct Rays {
    float lower_x, lower_y, upper_y, lower_z, upper_z;
  };
  // The boxes of eight children as far as a ray can miss them: it meets those with lower <= (y, z) <= upper and x <=
  // upper_x.
  struct alignas(32) Node {
    std::array<float, kWidth> lower_y, upper_y, lower_z, upper_z, upper_x;
    void clear();
    [[nodiscard]] unsigned met_by(const Rays& rays) const;  // bit i: child i, by any ray between
  };
  // Child i of node n of a level is node 8 n + i of the level before it; of the first level, triangle 8 n + i of
  // triangles_.
  using Level = std::vector<Node>;

  static Rays ray(const Vec3& origin);
  [[nodiscard]] bool share_descent(const Rays& rays) const;
  // Calls visit(n) for each node n of the first level that the rays may meet a child of.
  template <class Visit>
  void descend(const Rays& rays, const Visit& visit) const;

  void build(const TriangleMesh& mesh);
  [[nodiscard]] std::uint32_t curve(double y, double z) const;

  Box box_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Level> levels_;
};

inline unsigned ProjectedTree::Node::met_by(const Rays& rays) const {
  const __m128 x = _mm_set1_ps(rays.lower_x);
  const __m128 first_y = _mm_set1_ps(rays.lower_y), last_y = _mm_set1_ps(rays.upper_y);
  const __m128 first_z = _mm_set1_ps(rays.lower_z), last_z = _mm_set1_ps(rays.upper_z);
  unsigned met = 0;
  for (std::size_t i = 0; i < kWidth; i += 4) {  // SSE2, which every x86-64 has
    const __m128 in_y =
        _mm_and_ps(_mm_cmpge_ps(last_y, _mm_load_ps(&lower_y[i])), _mm_cmple_ps(first_y, _mm_load_ps(&upper_y[i])));
    const __m128 in_z =
        _mm_and_ps(_mm_cmpge_ps(last_z, _mm_load_ps(&lower_z[i])), _mm_cmple_ps(first_z, _mm_load_ps(&upper_z[i])));
    const __m128 ahead = _mm_cmple_ps(x, _mm_load_ps(&upper_x[i]));
    met |= static_cast<unsigned>(_mm_movemask_ps(_mm_and_ps(_mm_and_ps(in_y, in_z), ahead))) << i;
  }
  return met;
}

template <class Visit>
void ProjectedTree::descend(const Rays& rays, const Visit& visit) const {
  struct Place {
    std::uint32_t level;
    std::uint32_t node;
  };
  std::array<Place, 16 * kWidth> stack;  // at most 7 siblings wait per level, of 11 levels for 2^32 triangles
  std::size_t waiting = 0;
  stack[waiting++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
  while (waiting > 0) {
    const Place here = stack[--waiting];
    if (here.level == 0) {
      visit(here.node);
      continue;
    }
    for (unsigned met = levels_[here.level][here.node].met_by(rays); met != 0; met &= met - 1) {
      stack[waiting++] = {here.level - 1, here.node * static_cast<std::uint32_t>(kWidth) +
                                              static_cast<std::uint32_t>(std::countr_zero(met))};
    }
  }
}

template <class Visit>
void ProjectedTree::find(std::span<const Vec3> origins, const Visit& visit) const {
  std::array<Rays, kGroup> rays;
  for (std::size_t i = 0; i < origins.size(); ++i) rays[i] = ray(origins[i]);
  const auto look = [&](std::uint32_t node, std::size_t i) {
    for (unsigned met = levels_[0][node].met_by(rays[i]); met != 0; met &= met - 1) {
      visit(i, triangles_[node * kWidth + static_cast<std::size_t>(std::countr_zero(met))]);
    }
  };
  Rays all = rays[0];
  for (std::size_t i = 1; i < origins.size(); ++i) {
    all = {std::min(all.lower_x, rays[i].lower_x), std::min(all.lower_y, rays[i].lower_y),
           std::max(all.upper_y, rays[i].upper_y), std::min(all.lower_z, rays[i].lower_z),
           std::max(all.upper_z, rays[i].upper_z)};
  }
  if (share_descent(all)) {
    descend(all, [&](std::uint32_t node) {
      for (std::size_t i = 0; i < origins.size(); ++i) look(node, i);
    });
    return;
  }
  for (std::size_t i = 0; i < origins.size(); ++i) {
    descend(rays[i], [&](std::uint32_t node) { look(node, i); });
  }
}

}  // namespace raycone
