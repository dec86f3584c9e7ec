// What OpenVDB cannot hold is refused before any work is done.
#pragma once

#include <string>

#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"

namespace raycone::vdb {

// Throws OutputError where the lattice, or with --half the distances on it, do not fit. `name`: the output's.
void check_lattice(const PlacedLattice& lattice, const OutputDescription& description, const std::string& name);

}  // namespace raycone::vdb
