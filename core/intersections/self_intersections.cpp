#include "core/intersections/self_intersections.h"

#include <emmintrin.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <numeric>
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

// Halves of a box, whose differences do not overflow.
Box half_of(const Box& box) { return {0.5 * box.lower, 0.5 * box.upper}; }

// Which of the cubes of 1/2048 of a mesh's size a triangle is in, by the middle of its box.
class Cubes {
 public:
  static constexpr unsigned kBitsPerAxis = 11;

  explicit Cubes(const TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.triangles.empty()) return;
    const Box half = half_of(bounding_box(mesh));
    half_lower_ = half.lower;
    int exponent = 0;
    std::frexp(longest_side(half), &exponent);
    scale_ = PowerOfTwo(static_cast<int>(kBitsPerAxis) - exponent);
  }

  // Along Morton's curve through all of them.
  [[nodiscard]] std::uint64_t place_on_curve(std::uint32_t triangle) const {
    constexpr double kLast = (1U << kBitsPerAxis) - 1;
    const Vec3 half_middle = middle(half_of(box_of_triangle(mesh_, triangle)));
    std::uint64_t curve = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cube = std::clamp(scale_(half_middle[axis] - half_lower_[axis]), 0.0, kLast);
      curve |= spread_bits(static_cast<std::uint64_t>(cube)) << (2 - axis);
    }
    return curve;
  }

 private:
  const TriangleMesh& mesh_;
  Vec3 half_lower_;
  PowerOfTwo scale_{0};
};

// All triangles along Morton's curve through these cubes; within one by number. That is sorted sooner than runs are
// that medians cut, and by all threads.
std::vector<std::uint32_t> triangles_along_curve(const TriangleMesh& mesh) {
  constexpr unsigned kNumberBits = 31, kBucketBits = 12;
  static_assert(kMaxTriangles < std::uint64_t{1} << kNumberBits && kNumberBits + 3 * Cubes::kBitsPerAxis == 64);
  const Cubes cubes(mesh);
  const auto place = [&](std::size_t triangle) {
    return cubes.place_on_curve(static_cast<std::uint32_t>(triangle)) << kNumberBits | triangle;
  };
  const Buckets<std::uint64_t> buckets(mesh.triangles.size(), std::size_t{1} << kBucketBits,
                                       [&](std::size_t begin, std::size_t end, auto emit) {
                                         for (std::size_t i = begin; i < end; ++i) {
                                           const std::uint64_t at = place(i);
                                           emit(static_cast<std::size_t>(at >> (64 - kBucketBits)), at);
                                         }
                                       });
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  parallel_for_each(buckets.count(), 16, [&](std::size_t n) {
    const std::span<std::uint64_t> bucket = buckets[n];
    std::ranges::sort(bucket);
    std::ranges::transform(bucket, triangles.begin() + (bucket.data() - buckets[0].data()), [](std::uint64_t at) {
      return static_cast<std::uint32_t>(at & ((std::uint64_t{1} << kNumberBits) - 1));
    });
  });
  return triangles;
}

// A box as SIMD lanes take it. By halves, whose differences do not overflow.
struct HalfBox {
  __m128d lower, upper;  // x and y
  __m128d z;             // the lower one and the upper one

  explicit HalfBox(const Box& box)
      : lower(half(box.lower.x, box.lower.y)),
        upper(half(box.upper.x, box.upper.y)),
        z(half(box.lower.z, box.upper.z)) {}

 private:
  static __m128d half(double first, double second) { return _mm_mul_pd(_mm_set_pd(second, first), _mm_set1_pd(0.5)); }
};

// Up to eight boxes, in units of the box of them all: two boxes are told apart wherever they are in a mesh, and however
// large that is. Units of the whole mesh would make all boxes meet where a stray triangle is far away.
class alignas(64) Node {
 public:
  Node() = default;
  // `all`: the box of the children. Those that are missing are empty boxes, which meet nothing.
  Node(std::span<const Box> children, const Box& all) : half_lower_(0.5 * all.lower) {
    const double half_size = longest_side(half_of(all));
    units_ = half_size > 0.0 ? std::min(kUnits / half_size, std::numeric_limits<double>::max()) : 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower_[axis].fill(std::numeric_limits<std::int16_t>::max());
      upper_[axis].fill(std::numeric_limits<std::int16_t>::min());
    }
    for (std::size_t child = 0; child < children.size(); ++child) {
      std::array<std::int16_t, kWidth> sides;  // as in_units() has them
      const __m128i in_lanes = in_units(HalfBox(children[child]));
      std::memcpy(sides.data(), &in_lanes, sizeof sides);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower_[axis][child] = sides[kLower[axis]];
        upper_[axis][child] = sides[kUpper[axis]];
      }
    }
  }

  // A bit for each child whose closed box meets `box`, and for those of which that is not sure in these units.
  [[nodiscard]] unsigned meeting(const HalfBox& box) const {
    const __m128i sides = in_units(box);
    const __m128i apart =
        _mm_or_si128(_mm_or_si128(apart_along<0>(sides), apart_along<1>(sides)), apart_along<2>(sides));
    return ~static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(apart, apart))) & 0xFFU;
  }

 private:
  static constexpr double kUnits = 0x7FFE;  // of the longest side; what is beyond a box has one more or less
  static constexpr std::array<std::size_t, 3> kLower{0, 1, 4}, kUpper{2, 3, 5};  // lanes of in_units() by axis

  // Each step is monotone, so that boxes that meet have numbers that do.
  [[nodiscard]] __m128i in_units(const HalfBox& box) const {
    const __m128d from = _mm_loadu_pd(&half_lower_.x);
    const __m128i x_and_y = _mm_unpacklo_epi64(in_units(box.lower, from), in_units(box.upper, from));
    return _mm_packs_epi32(x_and_y, in_units(box.z, _mm_set1_pd(half_lower_.z)));
  }
  [[nodiscard]] __m128i in_units(__m128d half, __m128d from) const {
    const __m128d units = _mm_mul_pd(_mm_sub_pd(half, from), _mm_set1_pd(units_));
    return _mm_cvttpd_epi32(_mm_min_pd(_mm_max_pd(units, _mm_set1_pd(-1.0)), _mm_set1_pd(kUnits + 1)));
  }
  template <std::size_t kAxis>
  [[nodiscard]] __m128i apart_along(__m128i sides) const {
    return _mm_or_si128(_mm_cmpgt_epi16(load(lower_[kAxis]), in_all_lanes<kUpper[kAxis]>(sides)),
                        _mm_cmpgt_epi16(in_all_lanes<kLower[kAxis]>(sides), load(upper_[kAxis])));
  }
  static __m128i load(const std::array<std::int16_t, kWidth>& lanes) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(lanes.data()));
  }
  template <std::size_t kLane>
  static __m128i in_all_lanes(__m128i lanes) {
    constexpr int kOfHalf = static_cast<int>(kLane % 4) * 0x55;  // the lane in four places
    if constexpr (kLane < 4) return _mm_shuffle_epi32(_mm_shufflelo_epi16(lanes, kOfHalf), 0);
    return _mm_shuffle_epi32(_mm_shufflehi_epi16(lanes, kOfHalf), 0xAA);
  }

  std::array<std::array<std::int16_t, kWidth>, 3> lower_, upper_;  // by axis
  Vec3 half_lower_;
  double units_ = 0.0;  // per half of a length
};

// Boxes of the triangles in nodes of eight, boxes of nodes in nodes of eight, and so on.
class PairTree {
 public:
  PairTree(const TriangleMesh& mesh, SearchOrder order)
      : mesh_(mesh),
        triangles_(order == SearchOrder::kRuns ? triangles_in_runs(mesh, kWidth) : triangles_along_curve(mesh)) {
    Level level((triangles_.size() + kWidth - 1) / kWidth);
    std::vector<Box> boxes(level.size());
    parallel_for_each(level.size(), kGrain, [&](std::size_t run) {
      const RunBoxes of_run(*this, run);
      boxes[run] = of_run.all();
      level[run] = of_run.node();
    });
    while (level.size() > 1) {
      levels_.push_back(std::move(level));
      level = level_above(boxes);
    }
    levels_.push_back(std::move(level));
  }

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] std::uint32_t triangle(std::size_t place) const { return triangles_[place]; }
  [[nodiscard]] const Triangle& vertices(std::size_t place) const { return mesh_.triangles[triangles_[place]]; }
  [[nodiscard]] Corners3 corners(std::size_t place) const { return corners_of(mesh_, vertices(place)); }

  [[nodiscard]] std::size_t runs() const { return levels_.front().size(); }

  // Calls visit(place, other) for the places of a run of triangles and those behind each of them whose boxes meet, both
  // in increasing order, as long as it returns true. `runs` is for its own use.
  template <class Visit>
  void for_each_pair(std::size_t run, std::vector<std::size_t>& runs, const Visit& visit) const {
    runs.clear();
    const RunBoxes of_run(*this, run);
    find_runs(levels_.size() - 1, 0, run, HalfBox(of_run.all()), runs);
    for (std::size_t child = 0; child < of_run.size(); ++child) {
      const HalfBox box(of_run[child]);
      for (const std::size_t other : runs) {
        unsigned meeting = levels_.front()[other].meeting(box);
        if (other == run) meeting &= ~0U << (child + 1);
        for (; meeting != 0; meeting &= meeting - 1) {
          const auto of_other = static_cast<std::size_t>(std::countr_zero(meeting));
          if (!visit(run * kWidth + child, other * kWidth + of_other)) return;
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
    Box asked = empty_box();
    for (std::size_t place = run * kWidth; place < end; ++place) {
      if (is_asked(place)) extend(asked, box_at(place));
    }
    runs.clear();
    find_runs(levels_.size() - 1, 0, 0, HalfBox(asked), runs);
    for (std::size_t place = run * kWidth; place < end && !runs.empty(); ++place) {
      if (!is_asked(place)) continue;
      const HalfBox box(box_at(place));
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
  using Level = std::vector<Node>;

  // The boxes of a run of triangles.
  class RunBoxes {
   public:
    RunBoxes(const PairTree& tree, std::size_t run)
        : size_(std::min(kWidth, tree.triangles_.size() - run * kWidth)), all_(empty_box()) {
      for (std::size_t child = 0; child < size_; ++child) {
        boxes_[child] = tree.box_at(run * kWidth + child);
        extend(all_, boxes_[child]);
      }
    }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const Box& operator[](std::size_t child) const { return boxes_[child]; }
    [[nodiscard]] const Box& all() const { return all_; }
    [[nodiscard]] Node node() const { return {{boxes_.data(), size_}, all_}; }

   private:
    std::size_t size_;
    std::array<Box, kWidth> boxes_;
    Box all_;
  };

  // Of the triangle at a place.
  [[nodiscard]] Box box_at(std::size_t place) const { return box_of_triangle(mesh_, triangles_[place]); }

  // The nodes of those that have these boxes, which become the boxes of the new ones.
  static Level level_above(std::vector<Box>& boxes) {
    Level level((boxes.size() + kWidth - 1) / kWidth);
    for (std::size_t n = 0; n < level.size(); ++n) {
      const std::span<const Box> children(boxes.data() + n * kWidth, std::min(kWidth, boxes.size() - n * kWidth));
      const Box all = std::accumulate(children.begin(), children.end(), empty_box(), hull);
      level[n] = Node(children, all);
      boxes[n] = all;  // one of these children, or one that has been taken
    }
    boxes.resize(level.size());
    return level;
  }

  // Adds the runs from `first` on whose boxes meet a box, in increasing order. Child i of node n of a level is node
  // 8 n + i of the level below; nodes of the lowest level are runs.
  void find_runs(std::size_t level, std::size_t node, std::size_t first, const HalfBox& box,
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

std::optional<std::vector<TrianglePair>> intersecting_pairs(const TriangleMesh& mesh, std::size_t most) {
  const PairTree tree(mesh, SearchOrder::kRuns);
  std::mutex mutex;
  std::vector<TrianglePair> pairs;
  std::atomic<std::size_t> count{0};
  parallel_for(tree.runs(), kGrain, [&](std::size_t begin, std::size_t end) {
    PairMeeting meet(tree);
    std::vector<std::size_t> runs;
    std::vector<TrianglePair> found;
    for (std::size_t run = begin; run < end && count <= most; ++run) {
      tree.for_each_pair(run, runs, [&](std::size_t place, std::size_t other) {
        if (!meet(place, other)) return count <= most;
        found.push_back(*pair_at(tree, {place, other}));
        return ++count <= most;
      });
    }
    const std::scoped_lock lock(mutex);
    pairs.insert(pairs.end(), found.begin(), found.end());
  });
  if (count > most) return std::nullopt;
  std::ranges::sort(pairs);
  return pairs;
}

std::optional<TrianglePair> first_self_intersection(const TriangleMesh& mesh, const std::vector<std::uint8_t>* graphs) {
  const PairTree tree(mesh, SearchOrder::kRuns);
  std::mutex mutex;
  Places first;
  std::atomic<std::size_t> first_place{first.place};
  parallel_for(tree.runs(), kGrain, [&](std::size_t begin, std::size_t end) {
    PairMeeting meet(tree, graphs);
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
