#include "io/vdb/vdb_module.h"

extern "C" const raycone::vdb::Module raycone_vdb_module;
const raycone::vdb::Module raycone_vdb_module{&raycone::vdb::make_lattice_writer, &raycone::vdb::read_lattice,
                                              &raycone::vdb::read_facts};
