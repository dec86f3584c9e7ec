// What a lattice must be like for distances to be sampled on it, and to be written.
#pragma once

#include <string>

#include "app/options/field_options.h"
#include "core/data/lattice.h"
#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"

namespace raycone {

// Of `sdf` voxels must be cubes, of `solid` along the axes of the world, too. Throws UsageError, which names `remedy`.
void check_axes(const PlacedLattice& lattice, const FieldOptions& field, const std::string& remedy);

// Whether a band cuts anything off: a wider one is everywhere. `band`: voxels.
[[nodiscard]] bool cuts_off(double band, const Lattice& lattice);

// The format must hold distances of a voxel with all their digits, and those at the end of the band; but halves that
// nothing cuts off may do after all, as their writers find. Throws OutputError about the file `output`.
void check_digits(const std::string& output, const PlacedLattice& lattice, const FieldOptions& field,
                  FieldFormat format, const OutputDescription& description);

}  // namespace raycone
