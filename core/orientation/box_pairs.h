// Boxes that meet.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/data/box.h"

namespace raycone {

// The axis (0 to 2) along which boxes overlap least: the sum of their extents, each as a part of the extent of all, is
// smallest. Where all boxes lie in one plane, an axis within it.
[[nodiscard]] int axis_to_sweep(const std::vector<Box>& boxes);

// Calls visit(i, j) once for each two boxes that overlap(), in an order that depends on the boxes alone. Sweeps along
// one axis: takes n^2 time where all lie beside each other along all axes.
template <class Visit>
void for_each_overlapping_pair(const std::vector<Box>& boxes, const Visit& visit) {
  const int axis = axis_to_sweep(boxes);
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(boxes[i].lower[axis], i); });
  std::vector<std::uint32_t> met;  // which the next box may still reach
  for (const std::uint32_t j : order) {
    std::erase_if(met, [&](std::uint32_t i) { return boxes[i].upper[axis] < boxes[j].lower[axis]; });
    for (const std::uint32_t i : met) {
      if (overlap(boxes[i], boxes[j])) visit(i, j);
    }
    met.push_back(j);
  }
}

}  // namespace raycone
