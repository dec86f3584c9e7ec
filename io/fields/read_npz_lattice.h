// The lattice of an NPZ archive that raycone wrote, for --like.
#pragma once

#include <string>

#include "core/data/placed_lattice.h"

namespace raycone {

// Whether the regular file at `path` begins as an archive does; false where it cannot be read.
[[nodiscard]] bool is_npz(const std::string& path);

// Whether such a file has an array at all; false where it cannot be read.
[[nodiscard]] bool holds_arrays(const std::string& path);

// From its arrays origin, spacing, index_min and direction, and the shape of its first field. Throws InputError where
// the file cannot be read or has no valid lattice.
[[nodiscard]] PlacedLattice read_npz_lattice(const std::string& path);

}  // namespace raycone
