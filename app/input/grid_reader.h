// OpenVDB files, read by a process of its own: damaged ones crash OpenVDB, which trusts what it reads.
#pragma once

#include <string>
#include <vector>

#include "app/process/exit_code.h"
#include "core/data/placed_lattice.h"
#include "io/fields/volume_facts.h"

namespace raycone {

// The command that makes a process a reader of one grid; it is no part of the command line that users see.
inline constexpr const char* kGridReaderCommand = "grid-reader";

// What such a process does: reads what `words` tell, and writes what became of it. They are the number of a descriptor
// to write to (OpenVDB prints warnings to the standard ones), "lattice" or "facts", the path and the grid's name.
[[nodiscard]] ExitCode run_grid_reader(const std::vector<std::string>& words);

// read_vdb_lattice() of io/vdb/read_vdb.h, by this executable started anew, so that no thread of this process is
// missed. The other process says nothing, leaves no core file, and ends with this one at the latest. A crash is an
// InputError, too. Throws std::bad_alloc where the other one had no memory, and LimitError where there can be no other
// process.
[[nodiscard]] PlacedLattice read_grid_lattice(const std::string& path, const std::string& name);

// read_vdb_facts() likewise.
[[nodiscard]] VolumeFacts read_grid_facts(const std::string& path);

}  // namespace raycone
