#include "core/far/cover.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raycone {
namespace {

// In units of the time of a triangle: of a multipole, and of each of its terms.
constexpr double kExpansion = 1.5, kTerm = 0.06;

double expansion_cost(int degree) { return kExpansion + kTerm * (degree + 1) * (degree + 2); }

// Of `triangles`, ascending: nodes whose triangles are all among them as expansions of the degree that degree_of(node)
// says, where that is above 0 and pays.
template <class DegreeOf>
Cover cover(const SourceTree& tree, std::span<const std::uint32_t> triangles, double triangle_cost,
            const DegreeOf& degree_of) {
  Cover result;
  const std::span<const SourceNode> nodes = tree.nodes();
  auto at = triangles.begin();  // all before are covered
  for (std::size_t n = 0; n < nodes.size() && at != triangles.end();) {
    const SourceNode& node = nodes[n];
    if (*at >= node.end) {
      n = node.next;
      continue;
    }
    const auto end = std::lower_bound(at, triangles.end(), node.end);
    if (static_cast<std::size_t>(end - at) == node.triangles()) {
      const int degree = degree_of(node);
      if (degree > 0 && expansion_cost(degree) < triangle_cost * static_cast<double>(node.triangles())) {
        result.expansions.push_back({static_cast<std::uint32_t>(n), degree});
        result.cost += expansion_cost(degree);
        at = end;
        n = node.next;
        continue;
      }
    }
    const auto own_end = std::lower_bound(at, end, node.own_end);
    result.triangles.insert(result.triangles.end(), at, own_end);
    at = own_end;
    ++n;
  }
  result.cost += triangle_cost * static_cast<double>(result.triangles.size());
  return result;
}

// A little less than the distance of a point from a box.
double distance_from(const Box& box, const Vec3& p) { return std::sqrt(square_of_gap(box, p)) * (1 - 0x1p-40); }

}  // namespace

Cover cover_in(const SourceTree& tree, std::span<const std::uint32_t> triangles, const Box& box, double tolerance,
               double triangle_cost) {
  // Areas of nodes that have no triangle in common sum to that of the tree but for the rounding of sums.
  constexpr double kSlack = 1 - 0x1p-18;
  const double per_area = kSlack * tolerance / 2 / std::max(tree.area(), 0x1p-1000);
  const double per_triangle = tolerance / 2 / static_cast<double>(tree.triangles().size());
  return cover(tree, triangles, triangle_cost, [&](const SourceNode& node) {
    const double distance = distance_from(box, node.centre);
    if (node.order == 0 || distance <= node.radius) return 0;
    const double budget = per_area * node.area + per_triangle * static_cast<double>(node.triangles());
    int degree = node.order + 1;
    while (degree > 1 && SourceTree::error(node, degree - 1, distance) <= budget) --degree;
    return degree <= node.order ? degree : 0;
  });
}

}  // namespace raycone
