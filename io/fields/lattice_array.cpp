#include "io/fields/lattice_array.h"

namespace raycone {

std::string shape_of(const Lattice& lattice, std::size_t components) {
  return '(' + std::to_string(lattice.counts[0]) + ", " + std::to_string(lattice.counts[1]) + ", " +
         std::to_string(lattice.counts[2]) + (components > 1 ? ", " + std::to_string(components) : "") + ')';
}

int array_slab_axis(const Lattice& lattice, const OutputFile& output) {
  constexpr std::int64_t kSmallPlane = std::int64_t{1} << 16;  // slabs across x then hold rows that are long enough
  constexpr std::int64_t kLargePlane = std::int64_t{1} << 22;  // takes more memory than any slab has to
  const auto [nx, ny, nz] = lattice.counts;
  const std::int64_t across_x = ny * nz, across_y = nx * nz;
  return output.seekable() && across_x > kSmallPlane && across_y <= std::max(kLargePlane, across_x) ? 1 : 0;
}

}  // namespace raycone
