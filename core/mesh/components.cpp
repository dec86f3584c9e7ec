#include "core/mesh/components.h"

#include <algorithm>
#include <numeric>

namespace raycone {
namespace {

// Sets of numbers from 0 on, each number with a lower one or none above it.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t numbers) : count_(numbers), parent_(numbers) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  [[nodiscard]] std::size_t count() const { return count_; }

  void prefetch(std::uint32_t n) const { __builtin_prefetch(&parent_[n], 1); }

  void join(std::uint32_t a, std::uint32_t b) {
    if (parent_[a] == parent_[b]) return;
    const std::uint32_t i = root(a), j = root(b);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --count_;
  }

  // 0, 1 ... for the sets by their lowest numbers, per number for which is_used(number); kUnused for the others.
  template <class IsUsed>
  [[nodiscard]] std::vector<std::uint32_t> indices(const IsUsed& is_used) const {
    std::vector<std::uint32_t> indices(parent_.size(), Components::kUnused);
    std::uint32_t next = 0;
    for (std::size_t n = 0; n < parent_.size(); ++n) {
      if (is_used(n)) indices[n] = parent_[n] == n ? next++ : indices[parent_[n]];
    }
    return indices;
  }

 private:
  [[nodiscard]] std::uint32_t root(std::uint32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }

  std::size_t count_;
  std::vector<std::uint32_t> parent_;  // never higher than its number
};

}  // namespace

// Each vertex gets the label of the lower one that it is linked to: labels are as many as vertices that have no lower
// neighbour, few nearly always. The triangles then say which labels are one component. Some of them tell nearly all of
// that: the others then find equal labels at their corners (M. Sutton, T. Ben-Nun, A. Barak 2018).
Components components_of(const TriangleMesh& mesh, const VertexLinks& links) {
  Components components{0, std::vector<std::uint32_t>(mesh.vertices.size(), Components::kUnused)};
  std::vector<std::uint32_t>& label = components.of_vertex;
  for (std::size_t v = 0; v < label.size(); ++v) {
    if (!links.is_used(v)) continue;
    const std::uint32_t lower = links.lower(v);
    // Not by branches, which are a coin toss in some meshes.
    const std::uint32_t is_new = lower == v ? 1 : 0;
    label[v] = components.count * is_new + label[lower] * (1 - is_new);
    components.count += is_new;
  }
  if (components.count < 2) return components;
  constexpr std::size_t kSome = 4;
  for (const std::size_t step : {kSome, std::size_t{1}}) {
    DisjointSets sets(components.count);
    for (std::size_t i = 0; i < mesh.triangles.size() && sets.count() > 1; i += step) {
      const Triangle& t = mesh.triangles[i];
      const std::uint32_t a = label[t[0]], b = label[t[1]], c = label[t[2]];
      if (((a ^ b) | (a ^ c)) == 0) continue;
      sets.join(a, b);
      sets.join(a, c);
    }
    if (sets.count() == components.count) continue;
    components.count = static_cast<std::uint32_t>(sets.count());
    const std::vector<std::uint32_t> numbers = sets.indices([](std::size_t) { return true; });
    for (std::uint32_t& l : label) {
      if (l != Components::kUnused) l = numbers[l];
    }
    if (components.count == 1) break;
  }
  return components;
}

Components components_of(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);  // bits would wait for each other
  constexpr std::size_t kAhead = 16;                        // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) {
      for (const std::uint32_t v : mesh.triangles[i + kAhead]) sets.prefetch(v);
    }
    const Triangle& t = mesh.triangles[i];
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
    for (const std::uint32_t v : t) used[v] = 1;
  }
  const auto unused = static_cast<std::size_t>(std::ranges::count(used, 0));
  return {static_cast<std::uint32_t>(sets.count() - unused), sets.indices([&](std::size_t v) { return used[v] != 0; })};
}

}  // namespace raycone
