#include "core/mesh/edge_uses.h"

#include <algorithm>
#include <span>
#include <vector>

#include "core/mesh/edge_buckets.h"

namespace raycone {
namespace {

// One traversal of an edge, filed in the bucket of its lower vertex. From the top: the lower vertex counted from the
// bucket's first, 32 bits for the higher one, one bit for low to high.
class FiledTraversal {
 public:
  FiledTraversal() = default;
  FiledTraversal(std::uint32_t from, std::uint32_t to)
      : bits_(std::uint64_t{std::min(from, to) & kEdgeBucketMask} << kLowShift |
              std::uint64_t{std::max(from, to)} << 1 | std::uint64_t{from < to}) {}

  [[nodiscard]] std::uint32_t low_in_bucket() const { return static_cast<std::uint32_t>(bits_ >> kLowShift); }
  [[nodiscard]] std::uint32_t high() const { return static_cast<std::uint32_t>(bits_ >> 1); }
  [[nodiscard]] bool forward() const { return (bits_ & 1) != 0; }
  [[nodiscard]] std::uint64_t edge() const { return bits_ >> 1; }
  [[nodiscard]] std::uint64_t key() const { return bits_; }

 private:
  static constexpr int kLowShift = 33;
  std::uint64_t bits_;
};

// Calls visit for each edge whose traversals are in the bucket, by increasing low, then high.
template <class Visit>
void for_each_edge_in(std::span<const FiledTraversal> bucket, std::uint32_t first_vertex, const Visit& visit) {
  const std::vector<FiledTraversal> all = sorted_traversals(bucket);
  for (auto it = all.begin(); it != all.end();) {
    const std::uint64_t edge = it->edge();
    EdgeUse use{first_vertex + it->low_in_bucket(), it->high(), 0, 0};
    for (; it != all.end() && it->edge() == edge; ++it) ++(it->forward() ? use.forward : use.backward);
    visit(use);
  }
}

std::uint32_t first_vertex_of(std::size_t bucket) { return static_cast<std::uint32_t>(bucket << kEdgeBucketLog2); }

}  // namespace

void for_each_edge(const TriangleMesh& mesh, const std::function<void(const EdgeUse&)>& visit) {
  const auto buckets = traversals_of<FiledTraversal>(
      mesh.triangles, mesh.vertices.size(), [](std::size_t, auto from, auto to) { return FiledTraversal(from, to); });
  for (std::size_t n = 0; n < buckets.count(); ++n) {
    for_each_edge_in(std::span<const FiledTraversal>(buckets[n]), first_vertex_of(n), visit);
  }
}

}  // namespace raycone
