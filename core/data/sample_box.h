// Samples of a lattice or of a block of it, by their numbers along each axis.
#pragma once

#include <array>
#include <cstddef>

namespace raycone {

// Samples [begin, end) of each axis.
struct SampleBox {
  std::array<std::size_t, 3> begin, end;

  [[nodiscard]] std::size_t side(std::size_t axis) const { return end[axis] - begin[axis]; }
  [[nodiscard]] std::size_t size() const { return side(0) * side(1) * side(2); }
};

}  // namespace raycone
