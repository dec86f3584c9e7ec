#include "core/mesh/edge_uses.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "core/machine/buckets.h"

namespace raycone {
namespace {

// Traversals of neighbouring lower vertices share a bucket, which fits a cache and is sorted there.
constexpr int kBucketLog2 = 12;
constexpr std::uint32_t kBucketMask = (1U << kBucketLog2) - 1;

// One traversal of an edge, filed in the bucket of its lower vertex. From the top: the lower vertex counted from the
// bucket's first, 32 bits for the higher one, one bit for low to high.
using PackedTraversal = std::uint64_t;
constexpr int kLowShift = 33;

PackedTraversal traversal(std::uint32_t low, std::uint32_t high, bool forward) {
  return PackedTraversal{low & kBucketMask} << kLowShift | PackedTraversal{high} << 1 | PackedTraversal{forward};
}
std::uint32_t low_in_bucket(PackedTraversal t) { return static_cast<std::uint32_t>(t >> kLowShift); }
std::uint32_t high(PackedTraversal t) { return static_cast<std::uint32_t>(t >> 1); }
bool forward(PackedTraversal t) { return (t & 1) != 0; }

Buckets<PackedTraversal> traversals_of(const TriangleMesh& mesh) {
  const std::size_t count = (mesh.vertices.size() >> kBucketLog2) + 1;
  return {mesh.triangles.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
            for (std::size_t i = begin; i < end; ++i) {
              const Triangle& t = mesh.triangles[i];
              for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t from = t[corner], to = t[corner < 2 ? corner + 1 : 0];
                const std::uint32_t low = std::min(from, to);
                if (from != to) emit(low >> kBucketLog2, traversal(low, std::max(from, to), from < to));
              }
            }
          }};
}

// Few nearly always: six edges meet at a vertex of a large mesh.
void sort(std::span<PackedTraversal> traversals) {
  constexpr std::size_t kFew = 24;
  if (traversals.size() > kFew) return std::sort(traversals.begin(), traversals.end());
  for (std::size_t i = 1; i < traversals.size(); ++i) {
    const PackedTraversal t = traversals[i];
    std::size_t place = i;
    for (; place > 0 && traversals[place - 1] > t; --place) traversals[place] = traversals[place - 1];
    traversals[place] = t;
  }
}

// By lower vertex, then higher one: a counting sort, then one sort per lower vertex.
std::vector<PackedTraversal> sorted(std::span<const PackedTraversal> bucket) {
  std::array<std::size_t, kBucketMask + 3> begin{};  // one vertex may have more than 2^32
  for (const PackedTraversal t : bucket) ++begin[low_in_bucket(t) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<PackedTraversal> all(bucket.size());
  // begin[v + 1] is the next free place of vertex v, and its end when all are filled.
  for (const PackedTraversal t : bucket) all[begin[low_in_bucket(t) + 1]++] = t;
  for (std::size_t v = 0; v <= kBucketMask; ++v) sort(std::span(all).subspan(begin[v], begin[v + 1] - begin[v]));
  return all;
}

// Calls visit for each edge whose traversals are in the bucket, by increasing low, then high.
template <class Visit>
void for_each_edge_in(std::span<const PackedTraversal> bucket, std::uint32_t first_vertex, const Visit& visit) {
  const std::vector<PackedTraversal> all = sorted(bucket);
  for (auto it = all.begin(); it != all.end();) {
    const PackedTraversal edge = *it >> 1;
    EdgeUse use{first_vertex + low_in_bucket(*it), high(*it), 0, 0};
    for (; it != all.end() && *it >> 1 == edge; ++it) ++(forward(*it) ? use.forward : use.backward);
    visit(use);
  }
}

std::uint32_t first_vertex_of(std::size_t bucket) { return static_cast<std::uint32_t>(bucket << kBucketLog2); }

}  // namespace

void for_each_edge(const TriangleMesh& mesh, const std::function<void(const EdgeUse&)>& visit) {
  const Buckets<PackedTraversal> buckets = traversals_of(mesh);
  for (std::size_t n = 0; n < buckets.count(); ++n) for_each_edge_in(buckets[n], first_vertex_of(n), visit);
}

}  // namespace raycone
