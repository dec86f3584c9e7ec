#include "core/distance/distance_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/distance/triangle_distance.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Box box_of(const TriangleMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

// Sorts triangles into the tree's order.
class Order {
 public:
  explicit Order(const TriangleMesh& mesh) : centers_(mesh.triangles.size()), triangles_(mesh.triangles.size()) {
    std::iota(triangles_.begin(), triangles_.end(), std::uint32_t{0});
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const Box box = box_of(mesh, i);
      centers_[i] = box.lower + box.upper;
    }
  }

  // The triangles in runs of `width` that are close together, these in runs of `width` runs, and so on.
  std::vector<std::uint32_t> in_runs_of(std::size_t width) && {
    std::size_t run = width;
    while (run < triangles_.size()) run *= width;
    split(0, triangles_.size(), run / width, width);
    return std::move(triangles_);
  }

 private:
  // Arranges [begin, end), the start of which is one of a run of `run`, into runs of that and of shorter ones.
  void split(std::size_t begin, std::size_t end, std::size_t run, std::size_t width) {
    while (run >= width && end - begin <= run) run /= width;
    if (run < width) return;
    const std::size_t runs = (end - begin + run - 1) / run;
    const std::size_t middle = begin + (runs + 1) / 2 * run;
    const int axis = longest_axis(begin, end);
    const auto at = [this](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(n); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return centers_[a][axis] != centers_[b][axis] ? centers_[a][axis] < centers_[b][axis] : a < b;
    });
    constexpr std::size_t kWorthATask = 4096;
    if (end - begin < kWorthATask) {
      split(begin, middle, run, width);
      split(middle, end, run, width);
      return;
    }
    parallel_for(2, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t half = first; half < last; ++half) {
        half == 0 ? split(begin, middle, run, width) : split(middle, end, run, width);
      }
    });
  }

  [[nodiscard]] int longest_axis(std::size_t begin, std::size_t end) const {
    Box box{centers_[triangles_[begin]], centers_[triangles_[begin]]};
    for (std::size_t n = begin; n < end; ++n) {
      const Vec3& center = centers_[triangles_[n]];
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], center[axis]);
        box.upper[axis] = std::max(box.upper[axis], center[axis]);
      }
    }
    const Vec3 sides = box.upper - box.lower;
    return sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  }

  std::vector<Vec3> centers_;  // twice
  std::vector<std::uint32_t> triangles_;
};

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

DistanceTree::DistanceTree(const TriangleMesh& mesh) : mesh_(mesh), triangles_(Order(mesh).in_runs_of(kWidth)) {
  Level level((triangles_.size() + kWidth - 1) / kWidth);
  for (std::size_t n = 0; n < triangles_.size(); ++n) level[n / kWidth].set(n % kWidth, box_of(mesh, triangles_[n]));
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
