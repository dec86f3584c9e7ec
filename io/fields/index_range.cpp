#include "io/fields/index_range.h"

#include <cstddef>
#include <cstdint>
#include <limits>

#include "io/files/file_error.h"

namespace raycone {

void check_32_bit_indices(const Lattice& lattice, std::string_view format, const std::string& name) {
  using Index = std::numeric_limits<std::int32_t>;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t first = lattice.index_min[static_cast<std::size_t>(axis)], last = lattice.index_max(axis);
    if (first >= Index::min() && last <= Index::max()) continue;
    throw OutputError(name + ": lattice indices " + std::to_string(first) + " to " + std::to_string(last) +
                      " do not fit in the 32 bits of " + std::string(format));
  }
}

}  // namespace raycone
