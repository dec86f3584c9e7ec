// What OpenVDB files say: the lattice of a grid, for --like, and how it was made.
#pragma once

#include <string>

#include "core/data/placed_lattice.h"
#include "io/fields/volume_facts.h"

namespace raycone {

// Transform and extent of grid `name` of the file (empty: its only or first grid): the lattice that raycone recorded
// (metadata raycone_index_min, raycone_index_max), else the bounding box of the active voxels. Throws InputError where
// the file cannot be read, has no such grid, or its transform is not linear (a frustum). A damaged file may crash
// OpenVDB; meanwhile this process's memory is limited to what a file of that size can ask for.
[[nodiscard]] PlacedLattice read_vdb_lattice(const std::string& path, const std::string& name);

// Whether OpenVDB is in memory: reading or writing a VDB loads it once.
[[nodiscard]] bool vdb_module_is_loaded();

// All grids, the lattice of the first one, and how that was made. Throws and may crash likewise.
[[nodiscard]] VolumeFacts read_vdb_facts(const std::string& path);

}  // namespace raycone
