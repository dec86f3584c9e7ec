#include "core/mesh/components.h"

#include <algorithm>
#include <numeric>

namespace raycone {
namespace {

// Sets of labels, numbered from 0.
class LabelSets {
 public:
  explicit LabelSets(std::uint32_t labels) : count_(labels), parent_(labels) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }

  void join(std::uint32_t a, std::uint32_t b) {
    if (parent_[a] == parent_[b]) return;
    const std::uint32_t i = root(a), j = root(b);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --count_;
  }

  // Per label the number of its set; sets are numbered by their lowest labels.
  [[nodiscard]] std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> numbers(parent_.size());
    std::uint32_t next = 0;
    for (std::uint32_t l = 0; l < parent_.size(); ++l) numbers[l] = parent_[l] == l ? next++ : numbers[parent_[l]];
    return numbers;
  }

 private:
  [[nodiscard]] std::uint32_t root(std::uint32_t l) {
    while (parent_[l] != l) l = parent_[l] = parent_[parent_[l]];
    return l;
  }

  std::uint32_t count_;
  std::vector<std::uint32_t> parent_;  // lower than their children
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
    LabelSets sets(components.count);
    for (std::size_t i = 0; i < mesh.triangles.size() && sets.count() > 1; i += step) {
      const Triangle& t = mesh.triangles[i];
      const std::uint32_t a = label[t[0]], b = label[t[1]], c = label[t[2]];
      if (((a ^ b) | (a ^ c)) == 0) continue;
      sets.join(a, b);
      sets.join(a, c);
    }
    if (sets.count() == components.count) continue;
    components.count = sets.count();
    const std::vector<std::uint32_t> numbers = sets.numbers();
    for (std::uint32_t& l : label) {
      if (l != Components::kUnused) l = numbers[l];
    }
    if (components.count == 1) break;
  }
  return components;
}

Components components_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);  // bits would wait for each other
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  // Parents are lower than their children, so that a pass by increasing vertices finds all roots.
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    if (parent[a] == parent[b]) return;
    const std::uint32_t i = root(a), j = root(b);
    parent[std::max(i, j)] = std::min(i, j);
  };
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) {
      for (const std::uint32_t v : mesh.triangles[i + kAhead]) __builtin_prefetch(&parent[v], 1);
    }
    const Triangle& t = mesh.triangles[i];
    join(t[0], t[1]);
    join(t[0], t[2]);
    for (const std::uint32_t v : t) used[v] = 1;
  }
  Components components{0, std::vector<std::uint32_t>(mesh.vertices.size(), Components::kUnused)};
  for (std::size_t v = 0; v < parent.size(); ++v) {
    if (used[v] == 0) continue;
    components.of_vertex[v] = parent[v] == v ? components.count++ : components.of_vertex[parent[v]];
  }
  return components;
}

}  // namespace raycone
