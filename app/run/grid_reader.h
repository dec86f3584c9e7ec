// The grid of --like, read by a process of its own: damaged files crash OpenVDB, which trusts what it reads.
#pragma once

#include <string>
#include <vector>

#include "app/process/exit_code.h"
#include "core/data/lattice.h"

namespace raycone {

// The command that makes a process a reader of one grid; it is no part of the command line that users see.
inline constexpr const char* kGridReaderCommand = "grid-reader";

// What such a process does: reads the grid that `words` tell, and writes what became of it. They are the number of a
// descriptor to write to (OpenVDB prints warnings to the standard ones), the path and the name.
[[nodiscard]] ExitCode run_grid_reader(const std::vector<std::string>& words);

// read_vdb_lattice() of io/vdb/read_vdb.h, by this executable started anew, so that no thread of this process is
// missed. The other process says nothing, leaves no core file, and ends with this one at the latest. A crash is an
// InputError, too. Throws std::bad_alloc where the other one had no memory, and LimitError where there can be no other
// process.
[[nodiscard]] Lattice read_grid_lattice(const std::string& path, const std::string& name);

}  // namespace raycone
