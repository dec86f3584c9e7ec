// The lattice of an NRRD or NIfTI-1 volume, for --like.
#pragma once

#include <string>

#include "core/data/placed_lattice.h"

namespace raycone {

// Whether the regular file at `path` begins as one of them does, also where gzip packed it; false where it cannot be
// read.
[[nodiscard]] bool is_image(const std::string& path);

// Which of the two such a file is. Throws InputError where it cannot be read.
[[nodiscard]] bool is_nrrd(const std::string& path);

// Its voxels' middles, in right, anterior, superior; index 0 is the first one. Throws InputError where the head cannot
// be read, or does not say where the voxels lie.
[[nodiscard]] PlacedLattice read_image_lattice(const std::string& path);

}  // namespace raycone
