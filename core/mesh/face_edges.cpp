#include "core/mesh/face_edges.h"

#include <algorithm>

#include "core/machine/threads.h"
#include "core/mesh/edge_buckets.h"

namespace raycone {
namespace {

struct FiledEdge : FaceEdge {
  [[nodiscard]] std::uint32_t low_in_bucket() const { return low & kEdgeBucketMask; }
  [[nodiscard]] std::uint64_t key() const { return std::uint64_t{high} << 32 | face; }
};

}  // namespace

std::vector<FaceEdge> face_edges(const std::vector<Triangle>& triangles) {
  std::uint32_t last = 0;
  for (const Triangle& t : triangles) last = std::max({last, t[0], t[1], t[2]});
  const auto buckets = traversals_of<FiledEdge>(
      triangles, std::size_t{last} + 1, [](std::size_t face, std::uint32_t from, std::uint32_t to) {
        return FiledEdge{{std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(face), from < to}};
      });
  std::vector<FaceEdge> edges(buckets.all().size());
  parallel_for_each(buckets.count(), [&](std::size_t n) {
    const std::span<const FiledEdge> bucket = buckets[n];
    const std::vector<FiledEdge> sorted = sorted_traversals(bucket);
    std::ranges::copy(sorted, edges.begin() + (bucket.data() - buckets.all().data()));
  });
  return edges;
}

}  // namespace raycone
