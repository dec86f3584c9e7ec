#include "core/orientation/nesting.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "core/data/box.h"
#include "core/machine/threads.h"
#include "core/orientation/ray_sums.h"

namespace raycone {
namespace {

// That along which the fewest boxes lie beside each other: of all parts in a plane, one within it.
int axis_to_sweep(const std::vector<Box>& boxes) {
  Box all = empty_box();
  for (const Box& box : boxes) extend(all, box);
  std::array<double, 3> beside{};  // their extents in all, in units of that of all together
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto half_extent = [n = static_cast<int>(axis)](const Box& box) {  // by halves, which do not overflow
      return box.upper[n] / 2 - box.lower[n] / 2;
    };
    for (const Box& box : boxes)
      beside[axis] += half_extent(box) < half_extent(all) ? half_extent(box) / half_extent(all) : 1.0;
  }
  return static_cast<int>(std::ranges::min_element(beside) - beside.begin());
}

// For each box those that hold it.
std::vector<std::vector<std::uint32_t>> boxes_around(const std::vector<Box>& boxes) {
  const int axis = axis_to_sweep(boxes);
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(boxes[i].lower[axis], i); });
  std::vector<std::vector<std::uint32_t>> around(boxes.size());
  std::vector<std::uint32_t> met;
  for (const std::uint32_t i : order) {
    std::erase_if(met, [&](std::uint32_t j) { return boxes[j].upper[axis] < boxes[i].lower[axis]; });
    for (const std::uint32_t j : met) {
      if (contains(boxes[j], boxes[i])) around[i].push_back(j);
      if (contains(boxes[i], boxes[j])) around[j].push_back(i);
    }
    met.push_back(i);
  }
  return around;
}

// Vertices of a surface, each once: the first ones that its faces come to, up to `most`. `seen_by` is per vertex the
// number of the surface at which it was seen last.
std::vector<std::uint32_t> vertices_of(const ClosedSurface& surface, std::uint32_t number, std::size_t most,
                                       std::vector<std::uint32_t>& seen_by) {
  std::vector<std::uint32_t> found;
  for (const Triangle& t : surface.faces) {
    for (const std::uint32_t v : t) {
      if (std::exchange(seen_by[v], number) == number) continue;
      found.push_back(v);
      if (found.size() == most) return found;
    }
  }
  return found;
}

// Which surfaces lie within which, as far as the vertices tell that have been looked at.
class NestingCandidates {
 public:
  NestingCandidates(const std::vector<const ClosedSurface*>& surfaces, const std::vector<Vec3>& vertices,
                    std::vector<std::vector<std::uint32_t>> around)
      : surfaces_(surfaces), vertices_(vertices), around_(std::move(around)) {}

  // Keeps those around a surface within which up to `most` of its vertices lie: all that are not on them, and one.
  void look_at(std::size_t most) {
    const std::vector<std::vector<std::uint32_t>> used = used_vertices(most);
    std::vector<std::vector<std::uint32_t>> within(surfaces_.size());
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      for (const std::uint32_t outer : around_[i]) within[outer].push_back(i);
    }
    std::vector<std::vector<std::uint32_t>> dropped(surfaces_.size());
    parallel_for_each(surfaces_.size(), [&](std::size_t outer) {
      if (!within[outer].empty()) dropped[outer] = not_within(outer, within[outer], used, most);
    });
    std::vector<std::vector<std::uint32_t>> not_around(surfaces_.size());  // ascending
    for (std::uint32_t outer = 0; outer < surfaces_.size(); ++outer) {
      for (const std::uint32_t i : dropped[outer]) not_around[i].push_back(outer);
    }
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      std::erase_if(around_[i], [&](std::uint32_t outer) { return std::ranges::binary_search(not_around[i], outer); });
    }
  }

  [[nodiscard]] std::vector<std::vector<std::uint32_t>> take() { return std::move(around_); }

 private:
  // Of the surfaces that have others around them.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> used_vertices(std::size_t most) const {
    constexpr std::uint32_t kNoSurface = 0xFFFFFFFF;
    std::vector<std::uint32_t> seen_by(vertices_.size(), kNoSurface);
    std::vector<std::vector<std::uint32_t>> used(surfaces_.size());
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      if (!around_[i].empty()) used[i] = vertices_of(*surfaces_[i], i, most, seen_by);
    }
    return used;
  }

  // A surface of which all vertices that were looked at are on the other one is dropped only if these are all.
  [[nodiscard]] std::vector<std::uint32_t> not_within(std::size_t outer, const std::vector<std::uint32_t>& inner,
                                                      const std::vector<std::vector<std::uint32_t>>& used,
                                                      std::size_t most) const {
    std::vector<Vec3> points;
    for (const std::uint32_t i : inner) {
      for (const std::uint32_t v : used[i]) points.push_back(vertices_[v]);
    }
    const std::vector<RaySum> sums = ray_sums(surfaces_[outer]->faces, vertices_, points);
    std::vector<std::uint32_t> dropped;
    auto sum = sums.begin();
    for (const std::uint32_t i : inner) {
      bool misses = false, hits = false;
      for (const auto end = sum + static_cast<std::ptrdiff_t>(used[i].size()); sum != end; ++sum) {
        if (sum->on_surface) continue;
        (sum->winding == 0 ? misses : hits) = true;
      }
      if (misses || (!hits && used[i].size() < most)) dropped.push_back(i);
    }
    return dropped;
  }

  const std::vector<const ClosedSurface*>& surfaces_;
  const std::vector<Vec3>& vertices_;
  std::vector<std::vector<std::uint32_t>> around_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> surfaces_around(const std::vector<const ClosedSurface*>& surfaces,
                                                        const std::vector<Vec3>& vertices) {
  std::vector<Box> boxes;
  for (const ClosedSurface* surface : surfaces) boxes.push_back(bounding_box(surface->faces, vertices));
  NestingCandidates candidates(surfaces, vertices, boxes_around(boxes));
  constexpr std::size_t kFew = 16, kAll = std::numeric_limits<std::size_t>::max();
  candidates.look_at(kFew);  // enough nearly always where one is not around
  candidates.look_at(kAll);
  std::vector<std::vector<std::uint32_t>> around = candidates.take();
  for (auto& outer : around) std::sort(outer.begin(), outer.end());
  return around;
}

}  // namespace raycone
