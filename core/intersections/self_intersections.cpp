#include "core/intersections/self_intersections.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <utility>

#include "core/intersections/triangle_pair.h"
#include "core/machine/threads.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr std::size_t kWidth = 8;
constexpr std::size_t kGrain = 64;  // triangles

// Boxes of the triangles in nodes of eight, boxes of nodes in nodes of eight, and so on.
class PairTree {
 public:
  explicit PairTree(const TriangleMesh& mesh) : mesh_(mesh), triangles_(triangles_in_runs(mesh, kWidth)) {
    Level level((triangles_.size() + kWidth - 1) / kWidth);
    parallel_for(level.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin * kWidth; n < std::min(end * kWidth, triangles_.size()); ++n) {
        level[n / kWidth].set(n % kWidth, box_of_triangle(mesh_, triangles_[n]));
      }
    });
    while (level.size() > 1) {
      Level above((level.size() + kWidth - 1) / kWidth);
      for (std::size_t n = 0; n < level.size(); ++n) above[n / kWidth].set(n % kWidth, level[n].box());
      levels_.push_back(std::move(level));
      level = std::move(above);
    }
    levels_.push_back(std::move(level));
  }

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] std::uint32_t triangle(std::size_t place) const { return triangles_[place]; }
  [[nodiscard]] Corners3 corners(std::size_t place) const {
    const Triangle& t = mesh_.triangles[triangles_[place]];
    return {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]};
  }

  // Calls visit(other) for the places behind `place` whose boxes meet that of its triangle, in increasing order, as
  // long as it returns true.
  template <class Visit>
  void for_each_behind(std::size_t place, const Visit& visit) const {
    const Box box = box_of_triangle(mesh_, triangles_[place]);
    visit_behind(levels_.size() - 1, 0, place, box, visit);
  }

 private:
  struct alignas(64) Node {
    std::array<std::array<double, kWidth>, 3> lower, upper;  // by axis; empty boxes meet nothing
    Node() {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis].fill(std::numeric_limits<double>::infinity());
        upper[axis].fill(-std::numeric_limits<double>::infinity());
      }
    }
    void set(std::size_t child, const Box& box) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis][child] = box.lower[static_cast<int>(axis)];
        upper[axis][child] = box.upper[static_cast<int>(axis)];
      }
    }
    [[nodiscard]] Box box() const {
      Box all;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        all.lower[static_cast<int>(axis)] = *std::ranges::min_element(lower[axis]);
        all.upper[static_cast<int>(axis)] = *std::ranges::max_element(upper[axis]);
      }
      return all;
    }
    // A bit for each child whose closed box meets `box`.
    [[nodiscard]] unsigned meeting(const Box& box) const {
      std::array<unsigned, kWidth> meets;
      meets.fill(1);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = box.lower[static_cast<int>(axis)], high = box.upper[static_cast<int>(axis)];
        for (std::size_t i = 0; i < kWidth; ++i) {
          meets[i] &= static_cast<unsigned>(lower[axis][i] <= high) & static_cast<unsigned>(upper[axis][i] >= low);
        }
      }
      unsigned bits = 0;
      for (std::size_t i = 0; i < kWidth; ++i) bits |= meets[i] << i;
      return bits;
    }
  };
  using Level = std::vector<Node>;

  // Child i of node n of a level is node 8 n + i of the level below, of the lowest level the triangle at that place.
  template <class Visit>
  bool visit_behind(std::size_t level, std::size_t node, std::size_t place, const Box& box, const Visit& visit) const {
    const unsigned meeting = levels_[level][node].meeting(box);
    const std::size_t first_behind = (place + 1) >> (3 * level);  // children before it end before `place`
    for (std::size_t i = 0; i < kWidth; ++i) {
      const std::size_t child = node * kWidth + i;
      if ((meeting >> i & 1U) == 0 || child < first_behind) continue;
      const bool go_on = level == 0 ? visit(child) : visit_behind(level - 1, child, place, box, visit);
      if (!go_on) return false;
    }
    return true;
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Level> levels_;  // the triangles' first
};

struct Places {
  std::size_t place = std::numeric_limits<std::size_t>::max();
  std::size_t other = 0;
};

std::optional<TrianglePair> pair_at(const PairTree& tree, const Places& places) {
  if (places.place == Places().place) return std::nullopt;
  const auto [low, high] = std::minmax({tree.triangle(places.place), tree.triangle(places.other)});
  return TrianglePair{low, high};
}

}  // namespace

SelfIntersections self_intersections(const TriangleMesh& mesh) {
  const PairTree tree(mesh);
  std::vector<char> marked(tree.size(), 0);  // several threads may mark one
  const auto mark = [&](std::size_t place) {
    std::atomic_ref(marked[tree.triangle(place)]).store(1, std::memory_order_relaxed);
  };
  std::atomic<std::uint64_t> pairs{0};
  std::mutex mutex;
  Places first;
  parallel_for(tree.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint64_t found = 0;
    Places found_first;
    for (std::size_t place = begin; place < end; ++place) {
      const Corners3 corners = tree.corners(place);
      tree.for_each_behind(place, [&](std::size_t other) {
        if (!meet_beyond_shared(corners, tree.corners(other))) return true;
        if (found++ == 0) found_first = {place, other};
        mark(place);
        mark(other);
        return true;
      });
    }
    if (found == 0) return;
    pairs += found;
    const std::scoped_lock lock(mutex);
    if (found_first.place < first.place) first = found_first;
  });
  return {pairs, pair_at(tree, first), {marked.begin(), marked.end()}};
}

std::optional<TrianglePair> first_self_intersection(const TriangleMesh& mesh) {
  const PairTree tree(mesh);
  std::mutex mutex;
  Places first;
  std::atomic<std::size_t> first_place{first.place};
  parallel_for(tree.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    // A thread that is ahead of the first pair stops there; one behind it goes on, for there may be an earlier one.
    for (std::size_t place = begin; place < end && place < first_place; ++place) {
      const Corners3 corners = tree.corners(place);
      tree.for_each_behind(place, [&](std::size_t other) {
        if (!meet_beyond_shared(corners, tree.corners(other))) return place < first_place;
        const std::scoped_lock lock(mutex);
        if (place < first.place) first = {place, other};
        first_place = first.place;
        return false;
      });
    }
  });
  return pair_at(tree, first);
}

}  // namespace raycone
