#include "core/distance/distance_tree.h"

#include <algorithm>
#include <limits>

#include "core/distance/triangle_distance.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

DistanceTree::Node::Node() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis].fill(kInfinity);
    upper[axis].fill(-kInfinity);
  }
}

void DistanceTree::Node::set(std::size_t child, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis][child] = box.lower[static_cast<int>(axis)];
    upper[axis][child] = box.upper[static_cast<int>(axis)];
  }
}

Box DistanceTree::Node::box() const {
  Box all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.lower[static_cast<int>(axis)] = *std::ranges::min_element(lower[axis]);
    all.upper[static_cast<int>(axis)] = *std::ranges::max_element(upper[axis]);
  }
  return all;
}

std::array<double, DistanceTree::kWidth> DistanceTree::Node::bounds(const Vec3& p) const {
  std::array<double, kWidth> squares{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = p[static_cast<int>(axis)];
    for (std::size_t i = 0; i < kWidth; ++i) {
      const double below = lower[axis][i] - x, above = x - upper[axis][i];
      const double outside = std::max(std::max(below, above), 0.0);
      squares[i] += outside * outside;
    }
  }
  return squares;
}

DistanceTree::DistanceTree(const TriangleMesh& mesh) : mesh_(mesh), triangles_(triangles_in_runs(mesh, kWidth)) {
  Level level((triangles_.size() + kWidth - 1) / kWidth);
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    level[n / kWidth].set(n % kWidth, box_of_triangle(mesh, triangles_[n]));
  }
  while (level.size() > 1) {
    Level above((level.size() + kWidth - 1) / kWidth);
    for (std::size_t n = 0; n < level.size(); ++n) above[n / kWidth].set(n % kWidth, level[n].box());
    levels_.push_back(std::move(level));
    level = std::move(above);
  }
  levels_.push_back(std::move(level));
}

double DistanceTree::squared_distance(const Vec3& p, double limit) const {
  struct Candidate {
    double bound;
    std::uint32_t level;  // one above that of the node; 0: a triangle
    std::uint32_t index;
  };
  std::array<Candidate, 12 * kWidth> stack;  // at most 7 siblings wait per level, of 11 levels for 2^32 triangles
  std::size_t waiting = 0;
  stack[waiting++] = {0.0, static_cast<std::uint32_t>(levels_.size()), 0};
  double least = kInfinity;
  // What a triangle's own distance may be below that of its box, it may be below the least so far.
  double reach = beyond_error(limit);
  while (waiting > 0) {
    const Candidate here = stack[--waiting];
    if (here.bound >= reach) continue;
    if (here.level == 0) {
      const Triangle& t = mesh_.triangles[triangles_[here.index]];
      const TriangleDistance distance(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
      least = std::min(least, distance.squared(p));
      if (least == 0.0) return least;
      reach = std::min(reach, beyond_error(least));
      continue;
    }
    const std::array<double, kWidth> bounds = levels_[here.level - 1][here.index].bounds(p);
    const std::size_t first = waiting;
    for (std::size_t i = 0; i < kWidth; ++i) {
      if (!(bounds[i] < reach)) continue;
      // The farthest first: the nearest is on top of the stack.
      std::size_t at = waiting++;
      for (; at > first && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {bounds[i], here.level - 1, static_cast<std::uint32_t>(here.index * kWidth + i)};
    }
  }
  return least;
}

}  // namespace raycone
