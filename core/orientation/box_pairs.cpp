#include "core/orientation/box_pairs.h"

#include <array>

namespace raycone {

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

}  // namespace raycone
