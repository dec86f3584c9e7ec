// The lattice of an existing OpenVDB grid, for --like.
#pragma once

#include <string>

#include "core/data/lattice.h"

namespace raycone {

// Transform and extent of grid `name` of the file (empty: its only or first grid): the lattice that raycone recorded
// (metadata raycone_index_min, raycone_index_max), else the bounding box of the active voxels. Throws InputError where
// the file cannot be read, has no such grid, or its transform is not scale (positive) and translation only. A damaged
// file may crash OpenVDB; meanwhile this process's memory is limited to what a file of that size can ask for.
[[nodiscard]] Lattice read_vdb_lattice(const std::string& path, const std::string& name);

}  // namespace raycone
