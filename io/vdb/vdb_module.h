// The interface of the module raycone_vdb.so, which reads and writes OpenVDB files. It is a file of its own because
// OpenVDB takes tens of milliseconds to load, which runs that touch no VDB are spared. The module takes everything
// else of raycone from the executable that loads it, which exports its symbols for that; hence names here must not
// occur in the executable.
#pragma once

#include <memory>
#include <string>

#include "core/data/placed_lattice.h"
#include "io/fields/field_writer.h"
#include "io/fields/volume_facts.h"
#include "io/files/output_file.h"

namespace raycone::vdb {

// As make_vdb_lattice_writer() of io/fields/format_writers.h.
[[nodiscard]] std::unique_ptr<LatticeWriter> make_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                                 const OutputDescription& description);
// As read_vdb_lattice() of io/vdb/read_vdb.h.
[[nodiscard]] PlacedLattice read_lattice(const std::string& path, const std::string& name);
// As read_vdb_facts() there.
[[nodiscard]] VolumeFacts read_facts(const std::string& path);

// What the module is asked for, by the name kModuleSymbol.
struct Module {
  decltype(&make_lattice_writer) make_writer;
  decltype(&read_lattice) read;
  decltype(&read_facts) facts;
};

inline constexpr const char* kModuleFile = "raycone_vdb.so";
inline constexpr const char* kModuleSymbol = "raycone_vdb_module";

}  // namespace raycone::vdb
