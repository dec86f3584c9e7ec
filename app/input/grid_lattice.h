// The lattice of --like.
#pragma once

#include "app/options/lattice_request.h"
#include "core/data/placed_lattice.h"

namespace raycone {

// The lattice of an OpenVDB, NPZ, NRRD or NIfTI-1 file, whichever it is by its content. Throws InputError where there
// is none.
[[nodiscard]] PlacedLattice lattice_of_grid(const GridReference& grid);

// The same samples as a lattice along the axes of the world. Throws UsageError where the lattice's axes are not the
// world's; its text begins with `purpose`.
[[nodiscard]] Lattice world_lattice_of_grid(const GridReference& grid, const char* purpose);

}  // namespace raycone
