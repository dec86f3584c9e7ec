// What a lattice must be like for distances to be sampled on it, and to be written.
#pragma once

#include <string>

#include "app/options/field_options.h"
#include "core/data/lattice.h"
#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// For `sdf`, voxels must be cubes; for `solid`, axes must be the world's, too. Throws UsageError, whose text names
// `remedy`.
void check_axes(const PlacedLattice& lattice, const FieldOptions& field, const std::string& remedy);

// Whether a band (voxels) cuts anything off `lattice`: one as wide as the lattice does not.
[[nodiscard]] bool cuts_off(double band, const Lattice& lattice);

// The format must hold distances of a voxel with all their digits, and distances as large as the band. Halves that
// nothing cuts off may do after all; their writers find out. Throws OutputError about the file `output`.
void check_digits(const std::string& output, const PlacedLattice& lattice, const FieldOptions& field,
                  FieldFormat format, const OutputDescription& description);

}  // namespace raycone
