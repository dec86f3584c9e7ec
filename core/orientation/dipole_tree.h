// Sums over many small surfaces from afar.
#pragma once

#include <cstdint>
#include <vector>

#include "core/orientation/surface_field.h"

namespace raycone {

// A tree over dipoles (Barill et al. 2018). Depends on their order only through ties.
class DipoleTree {
 public:
  // A surface with a radius above `reach` counts as if that were its radius: so few surfaces are near anywhere, and
  // sums are less exact. With a reach of 0 all surfaces are far everywhere.
  DipoleTree(std::vector<SurfaceDipole> dipoles, double reach);

  // Each surface with its sign from here on: 1, -1, or 0 to leave it out.
  void set_signs(const std::vector<int>& signs);

  // The sum of sign times winding number, in turns, over the surfaces that are far from q (SurfaceField::kFar).
  [[nodiscard]] double far_sum(const Vec3& q) const;

  // What one surface of sign 1 adds to far_sum().
  [[nodiscard]] double far_part(std::uint32_t surface, const Vec3& q) const;

  // Calls visit(surface) for each surface that is not far from q.
  template <class Visit>
  void for_each_near(const Vec3& q, const Visit& visit) const {
    visit_near(0, q, visit);
  }

 private:
  static constexpr std::uint32_t kLeaf = 4;  // surfaces
  struct Node {
    SurfaceDipole sum;
    std::uint32_t begin, end;    // in order_
    std::uint32_t children = 0;  // the first of two; 0: none
  };

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end);
  [[nodiscard]] static bool is_far(const SurfaceDipole& dipole, const Vec3& q) {
    const Vec3 r = q - dipole.centre;
    return dot(r, r) >= SurfaceField::kFar * SurfaceField::kFar * dipole.radius * dipole.radius;
  }
  [[nodiscard]] double far_sum(std::uint32_t node, const Vec3& q) const;
  template <class Visit>
  void visit_near(std::uint32_t node, const Vec3& q, const Visit& visit) const {
    const Node& n = nodes_[node];
    if (is_far(n.sum, q)) return;
    if (n.children != 0) {
      visit_near(n.children, q, visit);
      visit_near(n.children + 1, q, visit);
      return;
    }
    for (std::uint32_t i = n.begin; i < n.end; ++i) {
      if (!is_far(dipoles_[order_[i]], q)) visit(order_[i]);
    }
  }

  std::vector<SurfaceDipole> dipoles_;
  std::vector<int> signs_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace raycone
