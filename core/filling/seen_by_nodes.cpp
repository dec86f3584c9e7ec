#include "core/filling/seen_by_nodes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/cells/surface_cells.h"
#include "core/machine/sum_over.h"

namespace raycone {
namespace {

// Whether visit(middle) holds for each part of a triangle; parts are no longer than `size` along any axis.
template <class Visit>
bool holds_for_parts(const Corners3& corners, double size, const Visit& visit) {
  std::array<double, 3> sides{};  // each across from its corner
  for (std::size_t n = 0; n < 3; ++n) sides[n] = largest_coordinate(corners[(n + 1) % 3] - corners[(n + 2) % 3]);
  const auto apex = static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
  const Vec3 &a = corners[apex], &b = corners[(apex + 1) % 3], &c = corners[(apex + 2) % 3];
  if (sides[apex] <= size) return visit((1.0 / 3.0) * (a + b + c));
  const Vec3 middle = 0.5 * (b + c);
  return holds_for_parts({a, b, middle}, size, visit) && holds_for_parts({a, middle, c}, size, visit);
}

class MixedCells {
 public:
  explicit MixedCells(const NodeSet& inside) : inside_(inside), near_(blocks_of(inside.lattice())) {
    NodeSet mixed(near_.lattice());
    for_each_mixed_cell(
        inside, [&](const NodeSet::Node& cell) { mixed.insert(cell[0] / kSide, cell[1] / kSide, cell[2] / kSide); });
    mixed.for_each([&](const NodeSet::Node& block) { insert_around(block); });
  }

  // Whether a component passes through one of them. Precondition: it is within the lattice.
  [[nodiscard]] bool are_met_by(const std::vector<Triangle>& component, const std::vector<Vec3>& vertices) const {
    const auto is_not_mixed = [&](const Vec3& p) { return !is_mixed(cell_at(p)); };
    return std::ranges::any_of(
        component, [&](const Triangle& t) { return !holds_for_parts(in_steps(t, vertices), 1.0, is_not_mixed); });
  }

  [[nodiscard]] bool is_within_lattice(const Triangle& t, const std::vector<Vec3>& vertices) const {
    return std::ranges::all_of(in_steps(t, vertices), [&](const Vec3& p) { return is_within(p); });
  }

  // Whether all of a triangle is in or beside a block of cells with one of them. Precondition: it is within the
  // lattice.
  [[nodiscard]] bool are_near_to(const Triangle& t, const std::vector<Vec3>& vertices) const {
    return holds_for_parts(in_steps(t, vertices), static_cast<double>(kSide), [&](const Vec3& p) {
      const NodeSet::Node cell = cell_at(p);
      return near_.holds(cell[0] / kSide, cell[1] / kSide, cell[2] / kSide);
    });
  }

 private:
  static constexpr std::int64_t kSide = 4;  // of a block, cells

  static Lattice blocks_of(Lattice lattice) {
    for (std::int64_t& count : lattice.counts) count = count / kSide + 1;
    return lattice;
  }

  void insert_around(const NodeSet::Node& block) {
    const auto first = [&](std::size_t axis) { return std::max<std::int64_t>(block[axis] - 1, 0); };
    const auto last = [&](std::size_t axis) { return std::min(block[axis] + 1, near_.lattice().counts[axis] - 1); };
    for (std::int64_t k = first(2); k <= last(2); ++k) {
      for (std::int64_t j = first(1); j <= last(1); ++j) {
        for (std::int64_t i = first(0); i <= last(0); ++i) near_.insert(i, j, k);
      }
    }
  }

  // In steps of the lattice, from its first node.
  [[nodiscard]] Corners3 in_steps(const Triangle& t, const std::vector<Vec3>& vertices) const {
    Corners3 corners = corners_of(vertices, t);
    for (Vec3& corner : corners) corner = inside_.lattice().steps_from_first(corner);
    return corners;
  }

  [[nodiscard]] bool is_within(const Vec3& steps) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(steps[axis] >= 0.0 && steps[axis] <= static_cast<double>(inside_.count(axis) - 1))) return false;
    }
    return true;
  }

  [[nodiscard]] static NodeSet::Node cell_at(const Vec3& steps) {
    const auto along = [&](int axis) { return static_cast<std::int64_t>(steps[axis]); };
    return {along(0), along(1), along(2)};
  }

  // Precondition: the cell is within the lattice. Beyond its last nodes there is nothing.
  [[nodiscard]] bool is_mixed(const NodeSet::Node& cell) const {
    int inside = 0;
    for (unsigned corner = 0; corner < kuhn::kCorners; ++corner) {
      const NodeSet::Node node = SurfaceCells::node_at({cell, 0, 0}, corner);
      const bool is_there = node[0] < inside_.count(0) && node[1] < inside_.count(1) && node[2] < inside_.count(2);
      inside += is_there && inside_.holds(node[0], node[1], node[2]) ? 1 : 0;
    }
    return inside != 0 && inside != kuhn::kCorners;
  }

  const NodeSet& inside_;
  NodeSet near_;  // of blocks: those with a cell with nodes of both kinds, and those around them
};

}  // namespace

std::vector<Sight> sights_of(const NodeSet& inside, const std::vector<std::vector<Triangle>>& components,
                             const std::vector<Vec3>& vertices) {
  const MixedCells mixed(inside);
  const auto sight = [&](const std::vector<Triangle>& component) {
    const auto any = [&](const auto& is_so) {
      return sum_over(component.size(), [&](std::size_t n) { return is_so(component[n]) ? 1 : 0; }) > 0;
    };
    if (any([&](const Triangle& t) { return !mixed.is_within_lattice(t, vertices); })) return Sight::kInPart;
    if (!mixed.are_met_by(component, vertices)) return Sight::kUnseen;
    return any([&](const Triangle& t) { return !mixed.are_near_to(t, vertices); }) ? Sight::kInPart : Sight::kWhole;
  };
  std::vector<Sight> sights(components.size());
  std::ranges::transform(components, sights.begin(), sight);
  return sights;
}

}  // namespace raycone
