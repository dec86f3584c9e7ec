// The lattice of an NPZ archive that raycone wrote, for --like.
#pragma once

#include <string>

#include "core/data/lattice.h"

namespace raycone {

// Whether the regular file at `path` begins as an archive does; false where it cannot be read.
[[nodiscard]] bool is_npz(const std::string& path);

// From its arrays origin, spacing, index_min and direction, and the shape of its first field. Throws InputError where
// the file cannot be read, has no lattice, or one that is not along the axes.
[[nodiscard]] Lattice read_npz_lattice(const std::string& path);

}  // namespace raycone
