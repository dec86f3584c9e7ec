#include "core/crossings/lattice_rows.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace raycone {

LatticeRows rows_in_scale(const Lattice& lattice, const LatticeBlock& block,
                          const std::function<double(double)>& to_scale) {
  LatticeRows rows;
  const std::array<std::vector<double>*, 3> axes{&rows.xs, &rows.ys, &rows.zs};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (std::int64_t i = 0; i < block.counts[a]; ++i) {
      axes[a]->push_back(to_scale(lattice.coordinate(axis, block.first[a] + i)));
    }
    const double width = axes[a]->back() - axes[a]->front();
    const double per_unit = static_cast<double>(block.counts[a] - 1) / width;
    rows.samples_per_unit[axis] = std::isfinite(per_unit) ? per_unit : 0.0;
  }
  return rows;
}

}  // namespace raycone
