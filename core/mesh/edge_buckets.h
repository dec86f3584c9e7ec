// Edges by their lower vertices: what counting and pairing the faces at edges has in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/machine/buckets.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

// Traversals of neighbouring lower vertices share a bucket, which fits a cache and is sorted there.
inline constexpr int kEdgeBucketLog2 = 12;
inline constexpr std::uint32_t kEdgeBucketMask = (1U << kEdgeBucketLog2) - 1;

// make(face, from, to) makes the Traversal of each directed edge of the faces whose two vertices differ.
template <class Traversal, class Make>
[[nodiscard]] Buckets<Traversal> traversals_of(const std::vector<Triangle>& faces, std::size_t vertices,
                                               const Make& make) {
  return {faces.size(), (vertices >> kEdgeBucketLog2) + 1, [&](std::size_t begin, std::size_t end, auto emit) {
            for (std::size_t i = begin; i < end; ++i) {
              for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t from = faces[i][corner], to = faces[i][corner < 2 ? corner + 1 : 0];
                if (from != to) emit(std::min(from, to) >> kEdgeBucketLog2, make(i, from, to));
              }
            }
          }};
}

// Few nearly always: six edges meet at a vertex of a large mesh.
template <class Traversal>
void sort_by_key(std::span<Traversal> traversals) {
  constexpr std::size_t kFew = 24;
  if (traversals.size() > kFew) {
    std::ranges::sort(traversals, {}, &Traversal::key);
    return;
  }
  for (std::size_t i = 1; i < traversals.size(); ++i) {
    const Traversal t = traversals[i];
    std::size_t place = i;
    for (; place > 0 && traversals[place - 1].key() > t.key(); --place) traversals[place] = traversals[place - 1];
    traversals[place] = t;
  }
}

// A bucket by lower vertex, then key(): a counting sort, then one sort per lower vertex. low_in_bucket() is the lower
// vertex counted from the bucket's first.
template <class Traversal>
[[nodiscard]] std::vector<Traversal> sorted_traversals(std::span<const Traversal> bucket) {
  // One vertex may have more than 2^32.
  SortedByKey<Traversal> sorted(kEdgeBucketMask + 1, [&](const auto& emit) {
    for (const Traversal& t : bucket) emit(t.low_in_bucket(), t);
  });
  for (std::size_t v = 0; v < sorted.keys(); ++v) sort_by_key(sorted[v]);
  return std::move(sorted).release();
}

}  // namespace raycone
