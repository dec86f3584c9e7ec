#include "core/orientation/nesting_tree.h"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "core/data/box.h"
#include "core/machine/threads.h"
#include "core/orientation/canonical_face.h"

namespace raycone {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

// What tells surfaces apart, whatever their order.
class SurfacePlaces {
 public:
  SurfacePlaces(const std::vector<const ClosedSurface*>& surfaces, const std::vector<Vec3>& vertices)
      : surfaces_(surfaces), vertices_(vertices), boxes_(surfaces.size()), first_(surfaces.size()) {
    parallel_for_each(surfaces.size(), [&](std::size_t i) { boxes_[i] = bounding_box(surfaces[i]->faces, vertices); });
  }

  // A box that holds another one comes before it.
  [[nodiscard]] std::strong_ordering box_order(std::uint32_t a, std::uint32_t b) const {
    if (const auto order = lexicographic_order(boxes_[a].lower, boxes_[b].lower); order != 0) return order;
    return lexicographic_order(boxes_[b].upper, boxes_[a].upper);
  }
  [[nodiscard]] bool has_first_face(std::uint32_t a, std::uint32_t b) { return first_face(a) < first_face(b); }
  [[nodiscard]] bool is_before(std::uint32_t a, std::uint32_t b) {
    const auto order = box_order(a, b);
    return order != 0 ? order < 0 : has_first_face(a, b);
  }

 private:
  // Few surfaces are asked for it.
  const CanonicalFace& first_face(std::uint32_t i) {
    if (!first_[i]) first_[i] = first_canonical_face(surfaces_[i]->faces, vertices_);
    return *first_[i];
  }

  const std::vector<const ClosedSurface*>& surfaces_;
  const std::vector<Vec3>& vertices_;
  std::vector<Box> boxes_;
  std::vector<std::optional<CanonicalFace>> first_;
};

// Settles surfaces one by one, each when all around it are.
class TreeBuilder {
 public:
  TreeBuilder(Lists around, SurfacePlaces& places)
      : around_(std::move(around)), places_(places), depth_(around_.size(), 0), tree_{.parent = {}, .order = {}} {
    tree_.parent.resize(around_.size());
    drop_mutual();
  }

  NestingTree build() {
    const Lists within = lists_within();
    std::vector<std::size_t> waits_for(around_.size());
    for (std::uint32_t i = 0; i < around_.size(); ++i) {
      waits_for[i] = around_[i].size();
      if (waits_for[i] == 0) settle(i);
    }
    for (std::size_t next = 0; next < around_.size(); ++next) {
      if (next == tree_.order.size()) settle(first_of_circles());
      for (const std::uint32_t i : within[tree_.order[next]]) {
        if (--waits_for[i] == 0 && depth_[i] == 0) settle(i);
      }
    }
    return std::move(tree_);
  }

 private:
  // Surfaces that pass through themselves or touch may each be around the other: neither is the parent then.
  void drop_mutual() {
    Lists mutual(around_.size());
    for (std::uint32_t i = 0; i < around_.size(); ++i) {
      for (const std::uint32_t j : around_[i]) {
        if (places_.box_order(i, j) == 0 && std::ranges::binary_search(around_[j], i)) mutual[i].push_back(j);
      }
    }
    for (std::size_t i = 0; i < around_.size(); ++i) {
      if (mutual[i].empty()) continue;
      std::erase_if(around_[i], [&](std::uint32_t j) { return std::ranges::binary_search(mutual[i], j); });
    }
  }

  [[nodiscard]] Lists lists_within() const {
    Lists within(around_.size());
    for (std::uint32_t i = 0; i < around_.size(); ++i) {
      for (const std::uint32_t outer : around_[i]) within[outer].push_back(i);
    }
    return within;
  }

  void settle(std::uint32_t i) {
    std::uint32_t parent = i;
    for (const std::uint32_t outer : around_[i]) {
      if (depth_[outer] != 0 && (parent == i || is_farther_in(outer, parent))) parent = outer;
    }
    tree_.parent[i] = parent;
    tree_.order.push_back(i);
    depth_[i] = parent == i ? 1 : depth_[parent] + 1;
  }

  [[nodiscard]] bool is_farther_in(std::uint32_t a, std::uint32_t b) {
    return depth_[a] != depth_[b] ? depth_[a] > depth_[b] : places_.has_first_face(a, b);
  }

  // The first surface, by its place, that is not settled. What it waits for has its box, or would come before it.
  std::uint32_t first_of_circles() {
    if (by_place_.empty()) {
      by_place_.resize(around_.size());
      std::iota(by_place_.begin(), by_place_.end(), 0U);
      std::erase_if(by_place_, [&](std::uint32_t i) { return depth_[i] != 0; });
      std::ranges::sort(by_place_, [&](std::uint32_t a, std::uint32_t b) { return places_.is_before(a, b); });
    }
    while (depth_[by_place_[in_circles_]] != 0) ++in_circles_;
    return by_place_[in_circles_];
  }

  Lists around_;
  SurfacePlaces& places_;
  std::vector<std::uint32_t> depth_;  // surfaces in the longest chain that ends here; 0: not settled
  std::vector<std::uint32_t> by_place_;
  std::size_t in_circles_ = 0;  // all before this one in by_place_ are settled
  NestingTree tree_;
};

}  // namespace

NestingTree nesting_tree(std::vector<std::vector<std::uint32_t>> around,
                         const std::vector<const ClosedSurface*>& surfaces, const std::vector<Vec3>& vertices) {
  SurfacePlaces places(surfaces, vertices);
  return TreeBuilder(std::move(around), places).build();
}

}  // namespace raycone
