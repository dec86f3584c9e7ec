#include "core/far/cover.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace raycone {
namespace {

// In units of the time of a triangle: of a multipole, and of each of its terms.
constexpr double kExpansion = 1.5, kTerm = 0.06;

double expansion_cost(int degree) { return kExpansion + kTerm * (degree + 1) * (degree + 2); }

// Of `triangles`, ascending: nodes whose triangles are all among them as expansions of the degree that degree_of(node)
// says, where it says one and that pays; 0: they add nothing that counts.
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
      const std::optional<int> degree = degree_of(node);
      const double cost = degree.value_or(0) > 0 ? expansion_cost(*degree) : 0.0;
      if (degree && cost < triangle_cost * static_cast<double>(node.triangles())) {
        if (*degree > 0) result.expansions.push_back({static_cast<std::uint32_t>(n), *degree});
        result.cost += cost;
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
  return cover(tree, triangles, triangle_cost, [&](const SourceNode& node) -> std::optional<int> {
    const double distance = distance_from(box, node.centre);
    if (distance <= node.radius) return std::nullopt;
    const double budget = per_area * node.area + per_triangle * static_cast<double>(node.triangles());
    const std::optional<SourceTree::Cut> cut = SourceTree::least_cut(node, distance, budget);
    return cut ? std::optional(cut->degree) : std::nullopt;
  });
}

namespace {

constexpr double kInverse = (1 + 0x1p-30) / (4 * std::numbers::pi);  // of 4 pi

// Makes one rough cover.
class RoughWalk {
 public:
  RoughWalk(const SourceTree& tree, std::span<const TriangleExtent> extents, const Box& box,
            const RoughCoverOptions& options)
      : tree_(tree),
        extents_(extents),
        box_(box),
        interpolation_(options.interpolation),
        each_(options.each),
        small_(options.small_nodes == SmallNodes::kUnopened ? kSmall * norm(box.upper - box.lower) : 0.0) {}

  // With all that is below it.
  void take_node(std::uint32_t number) {
    const std::span<const SourceNode> nodes = tree_.nodes();
    for (std::uint32_t n = number; n < nodes[number].next;) {
      if (take_whole(n)) {
        n = nodes[n].next;
        continue;
      }
      for (std::uint32_t i = nodes[n].begin; i < nodes[n].own_end; ++i) take_triangle(i);
      ++n;
    }
  }

  void take_triangle(std::uint32_t number) {
    constexpr double kOfTriangle = 0.25;  // what is spared is less than for a node
    const TriangleExtent& triangle = extents_[number];
    double square = square_of_gap(box_, triangle.box) * (1 - 0x1p-40);
    const bool is_large = square_of_diagonal(triangle.box) > square_of_diagonal(box_);
    if (is_large && !(bend_of(triangle, square) <= kOfTriangle * each_)) {
      square = square_of_gap(tree_.triangles()[number], triangle, box_);
    }
    const double solid_angle = solid_angle_of(triangle, square), bend = bend_of(triangle, square);
    if (solid_angle <= kOfTriangle * each_) {
      result_.error += solid_angle;
    } else if (bend <= kOfTriangle * each_) {
      result_.smooth.triangles.push_back(number);
      result_.error += bend;
    } else {
      result_.near.triangles.push_back(number);
      result_.near.cost += 1.0;
    }
  }

  RoughCover finish() {
    result_.error *= 1 + kManySumsRound;
    result_.near_error *= 1 + kManySumsRound;
    return std::move(result_);
  }

 private:
  static constexpr double kLeastSquare = 0x1p-200;   // of less, powers and areas may underflow
  static constexpr double kManySumsRound = 0x1p-20;  // of up to 2^32 numbers
  static constexpr double kSmall = 0.25;             // radius, as a part of the box's diagonal

  // Whether the node is taken as it is.
  bool take_whole(std::uint32_t number) {
    constexpr double kMuch = 2.0;  // of what is near, an expansion must spare that times its cost
    const SourceNode& node = tree_.nodes()[number];
    const double distance = distance_from(box_, node.centre), gap = distance - node.radius;
    if (!(gap > 0.0)) {
      if (node.radius < small_) result_.unopened.push_back(number);
      return node.radius < small_;
    }
    const double bend = bend_of(node.area, gap * gap);
    const bool smooth = bend <= each_;
    const auto cut = SourceTree::least_cut(node, distance, smooth ? each_ / interpolation_.growth : each_);
    if (!cut) return false;
    if (cut->degree == 0) {
      result_.error += cut->error;
      return true;
    }
    const double cost = expansion_cost(cut->degree), triangles = static_cast<double>(node.triangles());
    // Parts of a node that is not smooth may be.
    const bool has_parts = node.own_end != node.end;
    if (!(smooth ? cost < triangles : kMuch * cost < triangles && !has_parts)) return false;
    if (smooth) {
      result_.smooth.expansions.push_back({number, cut->degree});
      result_.error += bend + interpolation_.growth * cut->error;
    } else {
      result_.near.expansions.push_back({number, cut->degree});
      result_.near.cost += cost;
      result_.near_error += cut->error;
    }
    return true;
  }

  // By how much interpolation is off because of triangles of this area, as far away as the root of `square`: their
  // derivatives of order k, over the factorial of k, are at most (k + 1) A / (4 pi d^(k + 2)).
  [[nodiscard]] double bend_of(double area, double square) const {
    static_assert(Interpolation::kOrder == 4);
    if (!(square > kLeastSquare)) return std::numeric_limits<double>::infinity();
    return interpolation_.bend * (Interpolation::kOrder + 1) * kInverse * area / (square * square * square);
  }

  // What is farther away counts for less: of a slender triangle, and of a large one, as much as docs/method.md says.
  [[nodiscard]] double bend_of(const TriangleExtent& triangle, double square) const {
    constexpr double kOfWidth = 3 * std::numbers::pi / 8 * (1 + 0x1p-40), kOfAny = std::numbers::pi / 2 * (1 + 0x1p-40);
    const double slender = kOfWidth * triangle.width * std::sqrt(square);
    return bend_of(std::min({triangle.area, slender, kOfAny * square}), square);
  }

  // In turns, at most.
  [[nodiscard]] static double solid_angle_of(const TriangleExtent& triangle, double square) {
    constexpr double kOfWidth = std::numbers::pi * (1 + 0x1p-40);
    if (!(square > kLeastSquare)) return std::numeric_limits<double>::infinity();
    return kInverse * std::min(triangle.area, kOfWidth * triangle.width * std::sqrt(square)) / square;
  }

  const SourceTree& tree_;
  std::span<const TriangleExtent> extents_;
  const Box& box_;
  Interpolation interpolation_;
  double each_, small_;
  RoughCover result_;
};

}  // namespace

RoughCover rough_cover_in(const SourceTree& tree, std::span<const TriangleExtent> extents, const Box& box,
                          const RoughCoverOptions& options, const RoughCover* around) {
  RoughWalk walk(tree, extents, box, options);
  if (around) {
    for (const auto& [node, degree] : around->near.expansions) walk.take_node(node);
    for (const std::uint32_t node : around->unopened) walk.take_node(node);
    for (const std::uint32_t triangle : around->near.triangles) walk.take_triangle(triangle);
  } else if (!tree.nodes().empty()) {
    walk.take_node(0);
  }
  return walk.finish();
}

CoverSums::CoverSums(const SourceTree& tree, const Cover& cover, const Box& samples, const CoverKernels& kernels)
    : tree_(tree), cover_(cover), kernels_(kernels) {
  triangles_.reserve(cover.triangles.size());
  std::vector<std::uint32_t> large;
  for (const std::uint32_t n : cover.triangles) {
    const SolidTriangle& triangle = tree.triangles()[n];
    if (looks_small_from(triangle, samples)) {
      triangles_.push_back(triangle);
    } else {
      large.push_back(n);
    }
  }
  const std::size_t small = triangles_.size();
  for (const std::uint32_t n : large) triangles_.push_back(tree.triangles()[n]);
  corners_ = SharedCorners(triangles_);
  corners_.add_group(small, GroupLooks::kSmall);
  corners_.add_group(triangles_.size() - small, GroupLooks::kAny);
}

}  // namespace raycone
