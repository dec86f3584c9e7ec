#include "core/intersections/self_intersections.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "core/intersections/curve_order.h"
#include "core/intersections/pair_tree.h"
#include "core/intersections/triangle_pair.h"
#include "core/machine/threads.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr std::size_t kGrain = 8;  // runs of triangles

std::vector<std::uint32_t> in_order(const TriangleMesh& mesh, SearchOrder order) {
  return order == SearchOrder::kRuns ? triangles_in_runs(mesh, PairTree::kWidth) : triangles_along_curve(mesh);
}

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
  const PairTree tree(mesh, in_order(mesh, order));
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
  const PairTree tree(mesh, in_order(mesh, SearchOrder::kRuns));
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
  const PairTree tree(mesh, in_order(mesh, SearchOrder::kRuns));
  std::mutex mutex;
  Places first;
  std::atomic<std::size_t> first_place{first.place};
  parallel_for(tree.runs(), kGrain, [&](std::size_t begin, std::size_t end) {
    PairMeeting meet(tree, graphs);
    std::vector<std::size_t> runs;
    // A thread that is ahead of the first pair stops there; one behind it goes on, for there may be an earlier one.
    for (std::size_t run = begin; run < end && run * PairTree::kWidth < first_place; ++run) {
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
