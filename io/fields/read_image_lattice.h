// The heads of NRRD and NIfTI-1 volumes, and their lattices.
#pragma once

#include <string>
#include <variant>

#include "core/data/placed_lattice.h"
#include "io/fields/nifti_head.h"
#include "io/fields/nrrd_head.h"

namespace raycone {

// Whether the regular file at `path` begins as one of them does, also where gzip packed it; false where it cannot be
// read.
[[nodiscard]] bool is_image(const std::string& path);

// Throws InputError about a regular file that is none of what --like takes: what it is, as far as that is known, and
// what is expected.
[[noreturn]] void fail_as_unknown_volume(const std::string& path);

using ImageHead = std::variant<NrrdHead, NiftiHead>;

// Of such a file. Throws InputError where it cannot be read or its head is damaged.
[[nodiscard]] ImageHead read_image_head(const std::string& path);

// Its voxels' middles, in right, anterior, superior; index 0 is the first one. Throws InputError where the head cannot
// be read, or does not say where the voxels lie.
[[nodiscard]] PlacedLattice read_image_lattice(const std::string& path);
// The same of a head that has been read from there.
[[nodiscard]] PlacedLattice image_lattice(const std::string& path, const ImageHead& head);

}  // namespace raycone
