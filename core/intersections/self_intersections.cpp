#include "core/intersections/self_intersections.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <span>
#include <utility>

#include "core/data/space_curve.h"
#include "core/exact/scale.h"
#include "core/intersections/triangle_pair.h"
#include "core/machine/buckets.h"
#include "core/machine/threads.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr std::size_t kWidth = 8;
constexpr std::size_t kGrain = 8;  // runs of triangles

// Numbers for coordinates, in an order that they do not contradict: boxes that meet have numbers that do. As many bits
// as tell them apart in a mesh, wherever that is.
class BoxNumbers {
 public:
  explicit BoxNumbers(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return;
    const Box box = bounding_box(mesh);
    half_lower_ = 0.5 * box.lower;
    const Vec3 half_size = 0.5 * box.upper - half_lower_;
    int exponent = 0;
    std::frexp(std::max({half_size.x, half_size.y, half_size.z}), &exponent);
    scale_ = PowerOfTwo(-exponent);
  }

  // Rounding is monotone, and so is this.
  [[nodiscard]] float of(double x, int axis) const {
    return static_cast<float>(scale_(0.5 * x - half_lower_[axis]));  // halves, which do not overflow
  }

 private:
  Vec3 half_lower_;
  PowerOfTwo scale_{0};
};

struct NumberBox {
  std::array<float, 3> lower, upper;
};

// All triangles along Morton's curve: of the cubes of 1/2048 of the mesh's size that their boxes' middles are in;
// within one by number. That is sorted sooner than runs are that medians cut, and by all threads.
std::vector<std::uint32_t> triangles_along_curve(const TriangleMesh& mesh, const BoxNumbers& numbers) {
  constexpr unsigned kNumberBits = 31, kBitsPerAxis = 11, kBucketBits = 12;
  static_assert(kMaxTriangles < std::uint64_t{1} << kNumberBits && kNumberBits + 3 * kBitsPerAxis == 64);
  constexpr float kCubes = 1U << kBitsPerAxis;
  const auto place = [&](std::size_t triangle) {
    const Box box = box_of_triangle(mesh, static_cast<std::uint32_t>(triangle));
    std::uint64_t curve = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float middle = (numbers.of(box.lower[axis], axis) + numbers.of(box.upper[axis], axis)) / 2;
      curve |= spread_bits(static_cast<std::uint64_t>(std::clamp(middle * kCubes, 0.0F, kCubes - 1))) << (2 - axis);
    }
    return curve << kNumberBits | triangle;
  };
  const Buckets<std::uint64_t> buckets(mesh.triangles.size(), std::size_t{1} << kBucketBits,
                                       [&](std::size_t begin, std::size_t end, auto emit) {
                                         for (std::size_t i = begin; i < end; ++i) {
                                           const std::uint64_t at = place(i);
                                           emit(static_cast<std::size_t>(at >> (64 - kBucketBits)), at);
                                         }
                                       });
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  parallel_for(buckets.count(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::span<std::uint64_t> bucket = buckets[n];
      std::ranges::sort(bucket);
      std::ranges::transform(bucket, triangles.begin() + (bucket.data() - buckets[0].data()), [](std::uint64_t at) {
        return static_cast<std::uint32_t>(at & ((std::uint64_t{1} << kNumberBits) - 1));
      });
    }
  });
  return triangles;
}

// Boxes of the triangles in nodes of eight, boxes of nodes in nodes of eight, and so on.
class PairTree {
 public:
  PairTree(const TriangleMesh& mesh, SearchOrder order)
      : mesh_(mesh),
        numbers_(mesh),
        triangles_(order == SearchOrder::kRuns ? triangles_in_runs(mesh, kWidth)
                                               : triangles_along_curve(mesh, numbers_)) {
    Level level((triangles_.size() + kWidth - 1) / kWidth);
    parallel_for(level.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin * kWidth; n < std::min(end * kWidth, triangles_.size()); ++n) {
        level[n / kWidth].set(n % kWidth, box_at(n));
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
  [[nodiscard]] const Triangle& vertices(std::size_t place) const { return mesh_.triangles[triangles_[place]]; }
  [[nodiscard]] Corners3 corners(std::size_t place) const {
    const Triangle& t = vertices(place);
    return {mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]};
  }

  [[nodiscard]] std::size_t runs() const { return levels_.front().size(); }

  // Calls visit(place, other) for the places of a run of triangles and those behind each of them whose boxes meet, both
  // in increasing order, as long as it returns true. `runs` is for its own use.
  template <class Visit>
  void for_each_pair(std::size_t run, std::vector<std::size_t>& runs, const Visit& visit) const {
    runs.clear();
    find_runs(levels_.size() - 1, 0, run, levels_.front()[run].box(), runs);
    for (std::size_t place = run * kWidth; place < std::min((run + 1) * kWidth, triangles_.size()); ++place) {
      const NumberBox box = box_at(place);
      for (const std::size_t other : runs) {
        unsigned meeting = levels_.front()[other].meeting(box);
        if (other == run) meeting &= ~0U << (place % kWidth + 1);
        for (; meeting != 0; meeting &= meeting - 1) {
          const auto child = static_cast<std::size_t>(std::countr_zero(meeting));
          if (!visit(place, other * kWidth + child)) return;
        }
      }
    }
  }

  // The same for those triangles of a run for which `of` is not 0, and all others whose boxes meet them; of two such
  // triangles the first one's run has the pair.
  template <class Visit>
  void for_each_pair_of(const std::vector<std::uint8_t>& of, std::size_t run, std::vector<std::size_t>& runs,
                        const Visit& visit) const {
    const auto is_asked = [&](std::size_t place) { return of[triangles_[place]] != 0; };
    const std::size_t end = std::min((run + 1) * kWidth, triangles_.size());
    Node asked;
    for (std::size_t place = run * kWidth; place < end; ++place) {
      if (is_asked(place)) asked.set(place % kWidth, box_at(place));
    }
    runs.clear();
    find_runs(levels_.size() - 1, 0, 0, asked.box(), runs);
    for (std::size_t place = run * kWidth; place < end && !runs.empty(); ++place) {
      if (!is_asked(place)) continue;
      const NumberBox box = box_at(place);
      for (const std::size_t other_run : runs) {
        for (unsigned meeting = levels_.front()[other_run].meeting(box); meeting != 0; meeting &= meeting - 1) {
          const std::size_t other = other_run * kWidth + static_cast<std::size_t>(std::countr_zero(meeting));
          if (other == place || (other < place && is_asked(other))) continue;
          if (!visit(place, other)) return;
        }
      }
    }
  }

 private:
  struct alignas(64) Node {
    std::array<std::array<float, kWidth>, 3> lower, upper;  // by axis; empty boxes meet nothing
    Node() {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis].fill(std::numeric_limits<float>::infinity());
        upper[axis].fill(-std::numeric_limits<float>::infinity());
      }
    }
    void set(std::size_t child, const NumberBox& box) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis][child] = box.lower[axis];
        upper[axis][child] = box.upper[axis];
      }
    }
    [[nodiscard]] NumberBox box() const {
      NumberBox all;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        all.lower[axis] = *std::ranges::min_element(lower[axis]);
        all.upper[axis] = *std::ranges::max_element(upper[axis]);
      }
      return all;
    }
    // A bit for each child whose closed box meets `box`.
    [[nodiscard]] unsigned meeting(const NumberBox& box) const { return meeting(box, 0) | meeting(box, 4) << 4U; }

   private:
    // Of four children from one on. Compilers do not make vectors of such a loop by themselves.
    [[nodiscard]] unsigned meeting(const NumberBox& box, std::size_t first) const {
      using Four = float __attribute__((vector_size(16)));
      const auto four = [first](const std::array<float, kWidth>& numbers) {
        Four result;
        std::memcpy(&result, numbers.data() + first, sizeof result);
        return result;
      };
      const auto meets = (four(lower[0]) <= box.upper[0]) & (four(upper[0]) >= box.lower[0]) &
                         (four(lower[1]) <= box.upper[1]) & (four(upper[1]) >= box.lower[1]) &
                         (four(lower[2]) <= box.upper[2]) & (four(upper[2]) >= box.lower[2]);
      return static_cast<unsigned>((meets[0] & 1) | (meets[1] & 2) | (meets[2] & 4) | (meets[3] & 8));
    }
  };
  using Level = std::vector<Node>;

  // Of the triangle at a place.
  [[nodiscard]] NumberBox box_at(std::size_t place) const {
    const Box box = box_of_triangle(mesh_, triangles_[place]);
    NumberBox numbers;
    for (int axis = 0; axis < 3; ++axis) {
      numbers.lower[static_cast<std::size_t>(axis)] = numbers_.of(box.lower[axis], axis);
      numbers.upper[static_cast<std::size_t>(axis)] = numbers_.of(box.upper[axis], axis);
    }
    return numbers;
  }

  // Adds the runs from `first` on whose boxes meet a box, in increasing order. Child i of node n of a level is node
  // 8 n + i of the level below; nodes of the lowest level are runs.
  void find_runs(std::size_t level, std::size_t node, std::size_t first, const NumberBox& box,
                 std::vector<std::size_t>& runs) const {
    if (level == 0) {
      runs.push_back(node);
      return;
    }
    const std::size_t first_behind = first >> (3 * (level - 1));  // children before it end before `first`
    unsigned meeting = levels_[level][node].meeting(box);
    for (; meeting != 0; meeting &= meeting - 1) {
      const std::size_t child = node * kWidth + static_cast<std::size_t>(std::countr_zero(meeting));
      if (child >= first_behind) find_runs(level - 1, child, first, box, runs);
    }
  }

  const TriangleMesh& mesh_;
  BoxNumbers numbers_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Level> levels_;  // the triangles' first
};

// Asks about a triangle and one after the other of those behind it.
class PairMeeting {
 public:
  explicit PairMeeting(const PairTree& tree, const std::vector<std::uint8_t>* graphs = nullptr)
      : tree_(tree), graphs_(graphs) {}

  [[nodiscard]] bool operator()(std::size_t place, std::size_t other) {
    if (place != place_) enter(place);
    if (shares_graph(tree_.vertices(other))) return false;
    if (!meets_) meets_.emplace(tree_.corners(place));
    return (*meets_)(tree_.corners(other));
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  void enter(std::size_t place) {
    place_ = place;
    meets_.reset();
    for (std::size_t i = 0; i < at_graphs_.size() && graphs_; ++i) {
      const std::uint32_t vertex = tree_.vertices(place)[i];
      at_graphs_[i] = (*graphs_)[vertex] != 0 ? vertex : kNone;
    }
  }
  [[nodiscard]] bool shares_graph(const Triangle& other) const {
    unsigned shares = 0;  // not by branches, which nobody can foresee
    for (const std::uint32_t vertex : at_graphs_) {
      for (const std::uint32_t of_other : other) shares |= static_cast<unsigned>(vertex == of_other);
    }
    return shares != 0;
  }

  const PairTree& tree_;
  const std::vector<std::uint8_t>* graphs_;
  Triangle at_graphs_{kNone, kNone, kNone};  // the vertices of the first triangle that are graphs
  std::size_t place_ = std::numeric_limits<std::size_t>::max();
  std::optional<MeetsBeyondShared> meets_;  // made for the first pair that needs it
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

SelfIntersections self_intersections(const TriangleMesh& mesh, SearchOrder order,
                                     const std::vector<std::uint8_t>* graphs, const std::vector<std::uint8_t>* of) {
  const PairTree tree(mesh, order);
  std::vector<char> marked(tree.size(), 0);  // several threads may mark one
  const auto mark = [&](std::size_t place) {
    std::atomic_ref(marked[tree.triangle(place)]).store(1, std::memory_order_relaxed);
  };
  std::atomic<std::uint64_t> pairs{0};
  std::mutex mutex;
  Places first;
  parallel_for(tree.runs(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint64_t found = 0;
    Places found_first;
    PairMeeting meet(tree, graphs);
    std::vector<std::size_t> runs;
    const auto visit = [&](std::size_t place, std::size_t other) {
      if (!meet(place, other)) return true;
      if (found++ == 0) found_first = {place, other};
      mark(place);
      mark(other);
      return true;
    };
    for (std::size_t run = begin; run < end; ++run) {
      if (of) {
        tree.for_each_pair_of(*of, run, runs, visit);
      } else {
        tree.for_each_pair(run, runs, visit);
      }
    }
    if (found == 0) return;
    pairs += found;
    const std::scoped_lock lock(mutex);
    if (found_first.place < first.place) first = found_first;
  });
  return {pairs, pair_at(tree, first), {marked.begin(), marked.end()}};
}

std::optional<TrianglePair> first_self_intersection(const TriangleMesh& mesh) {
  const PairTree tree(mesh, SearchOrder::kRuns);
  std::mutex mutex;
  Places first;
  std::atomic<std::size_t> first_place{first.place};
  parallel_for(tree.runs(), kGrain, [&](std::size_t begin, std::size_t end) {
    PairMeeting meet(tree);
    std::vector<std::size_t> runs;
    // A thread that is ahead of the first pair stops there; one behind it goes on, for there may be an earlier one.
    for (std::size_t run = begin; run < end && run * kWidth < first_place; ++run) {
      tree.for_each_pair(run, runs, [&](std::size_t place, std::size_t other) {
        if (!meet(place, other)) return place < first_place;
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
