#include "core/orientation/face_neighbours.h"

#include <algorithm>
#include <span>

#include "core/machine/threads.h"
#include "core/mesh/edge_buckets.h"

namespace raycone {

struct FaceNeighbours::FiledEdge {
  std::uint32_t low, high;
  std::uint32_t face_and_direction;

  [[nodiscard]] std::uint32_t low_in_bucket() const { return low & kEdgeBucketMask; }
  [[nodiscard]] std::uint32_t face() const { return face_and_direction >> 1; }
  [[nodiscard]] bool forward() const { return (face_and_direction & 1) != 0; }
  [[nodiscard]] std::uint64_t key() const { return std::uint64_t{high} << 32 | face_and_direction; }
};

FaceNeighbours::FaceNeighbours(const std::vector<Triangle>& faces, std::size_t vertices) : neighbours_(faces.size()) {
  const auto buckets = traversals_of<FiledEdge>(faces, vertices, [](std::size_t face, auto from, auto to) {
    return FiledEdge{std::min(from, to), std::max(from, to),
                     static_cast<std::uint32_t>(face) << 1 | std::uint32_t{from < to}};
  });
  const auto set_neighbour = [&](const FiledEdge& t, std::uint32_t bits) {
    neighbours_[t.face()][place_in(faces[t.face()], t.forward() ? t.low : t.high)] = bits;
  };
  std::vector<std::vector<UnpairedEdge>> unpaired(buckets.count());
  parallel_for_each(buckets.count(), [&](std::size_t n) {
    const std::vector<FiledEdge> all = sorted_traversals(std::span<const FiledEdge>(buckets[n]));
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
  });
  for (auto& part : unpaired) unpaired_.insert(unpaired_.end(), part.begin(), part.end());
}

}  // namespace raycone
