// How large output will be at least, to be refused where the disk has no room for it.
#pragma once

#include <cstdint>

#include "io/fields/field_writer.h"

namespace raycone {

// The bytes that `samples` take at least, on a lattice or at points. Of NPY, NPZ, VTI, NRRD, NIfTI and raw points, what
// the numbers take; of CSV, what numbers of one digit would take. 0 of VDB, where constant blocks cost nothing,
// whatever their number, and of all that is compressed. At most 2^62.
[[nodiscard]] std::uint64_t least_lattice_file(FieldFormat format, const OutputDescription& description,
                                               std::uint64_t samples);
[[nodiscard]] std::uint64_t least_point_file(FieldFormat format, const OutputDescription& description,
                                             std::uint64_t samples);

}  // namespace raycone
