#include "core/boundary/sample_tile.h"

#include <algorithm>

namespace raycone {

void SampleTile::fill_up() {
  for (std::size_t i = count; i % 8 != 0; ++i) {
    x[i] = x[count - 1];
    y[i] = y[count - 1];
    z[i] = z[count - 1];
  }
}

bool SampleTile::share_a_ray() const {
  return std::all_of(y.begin(), y.begin() + count, [&](double value) { return value == y[0]; }) &&
         std::all_of(z.begin(), z.begin() + count, [&](double value) { return value == z[0]; });
}

}  // namespace raycone
