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

// What such a process does: reads a file and writes the result, or what went wrong. `words`: the number of a descriptor
// to write to (OpenVDB prints warnings to the standard ones), "lattice" or "facts", the path, and the grid's name.
[[nodiscard]] ExitCode run_grid_reader(const std::vector<std::string>& words);

// As read_vdb_lattice() (io/vdb/read_vdb.h), in a new process of this executable: a fork would lack this process's
// threads. The new process prints nothing, leaves no core file, and ends with this one at the latest. A crash of it is
// an InputError, too. Throws std::bad_alloc where it had no memory, and LimitError where it cannot be started.
[[nodiscard]] PlacedLattice read_grid_lattice(const std::string& path, const std::string& name);

// As read_vdb_facts(), likewise.
[[nodiscard]] VolumeFacts read_grid_facts(const std::string& path);

}  // namespace raycone
