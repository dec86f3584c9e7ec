#include "core/orientation/face_edges.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "core/machine/buckets.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Traversals of neighbouring lower vertices share a bucket, which fits a cache and is sorted there.
constexpr int kEdgeBucketLog2 = 12;
constexpr std::uint32_t kEdgeBucketMask = (1U << kEdgeBucketLog2) - 1;

}  // namespace

struct FaceEdges::FiledEdge {
  std::uint32_t low, high;
  std::uint32_t face_and_direction;

  [[nodiscard]] std::uint32_t face() const { return face_and_direction >> 1; }
  [[nodiscard]] bool forward() const { return (face_and_direction & 1) != 0; }
  [[nodiscard]] std::uint64_t key() const { return std::uint64_t{high} << 32 | face_and_direction; }
};

namespace {

std::size_t corner_of(const Triangle& t, std::uint32_t from) { return t[0] == from ? 0 : t[1] == from ? 1 : 2; }

// Few nearly always: six edges meet at a vertex of a large mesh.
template <class FiledEdge>
void sort_by_key(std::span<FiledEdge> edges) {
  constexpr std::size_t kFew = 24;
  if (edges.size() > kFew) {
    std::ranges::sort(edges, {}, &FiledEdge::key);
    return;
  }
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const FiledEdge edge = edges[i];
    std::size_t place = i;
    for (; place > 0 && edges[place - 1].key() > edge.key(); --place) edges[place] = edges[place - 1];
    edges[place] = edge;
  }
}

// By lower vertex, then higher one, then face: a counting sort, then one sort per lower vertex.
template <class FiledEdge>
std::vector<FiledEdge> sorted_traversals(std::span<const FiledEdge> bucket) {
  std::array<std::size_t, kEdgeBucketMask + 3> begin{};
  for (const FiledEdge& t : bucket) ++begin[(t.low & kEdgeBucketMask) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<FiledEdge> all(bucket.size());
  for (const FiledEdge& t : bucket) all[begin[(t.low & kEdgeBucketMask) + 1]++] = t;
  for (std::size_t v = 0; v <= kEdgeBucketMask; ++v) {
    sort_by_key(std::span(all).subspan(begin[v], begin[v + 1] - begin[v]));
  }
  return all;
}

}  // namespace

FaceEdges::FaceEdges(const std::vector<Triangle>& faces, std::size_t vertices) : neighbours_(faces.size()) {
  const std::size_t count = (vertices >> kEdgeBucketLog2) + 1;
  const Buckets<FiledEdge> buckets(faces.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t from = faces[i][corner], to = faces[i][corner < 2 ? corner + 1 : 0];
        const std::uint32_t low = std::min(from, to);
        const std::uint32_t face_and_direction = static_cast<std::uint32_t>(i) << 1 | std::uint32_t{from < to};
        emit(low >> kEdgeBucketLog2, FiledEdge{low, std::max(from, to), face_and_direction});
      }
    }
  });
  const auto set_neighbour = [&](const FiledEdge& t, std::uint32_t bits) {
    neighbours_[t.face()][corner_of(faces[t.face()], t.forward() ? t.low : t.high)] = bits;
  };
  std::vector<std::vector<UnpairedEdge>> unpaired(count);
  parallel_for(count, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const std::vector<FiledEdge> all = sorted_traversals<FiledEdge>(buckets[n]);
      for (auto it = all.begin(); it != all.end();) {
        auto end = it + 1;
        while (end != all.end() && end->low == it->low && end->high == it->high) ++end;
        if (end - it == 2) {
          const std::uint32_t disagree = it->forward() == it[1].forward();
          set_neighbour(it[0], it[1].face() << 1 | disagree);
          set_neighbour(it[1], it[0].face() << 1 | disagree);
        } else {
          UnpairedEdge& edge = unpaired[n].emplace_back(UnpairedEdge{it->low, it->high, {}});
          for (auto t = it; t != end; ++t) {
            set_neighbour(*t, kNone);
            edge.faces.push_back({t->face(), t->forward() ? 1 : -1});
          }
        }
        it = end;
      }
    }
  });
  for (auto& part : unpaired) unpaired_.insert(unpaired_.end(), part.begin(), part.end());
}

}  // namespace raycone
