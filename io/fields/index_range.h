// Lattices for formats that keep indices in 32 bits.
#pragma once

#include <string>
#include <string_view>

#include "core/data/lattice.h"

namespace raycone {

// Throws OutputError where an index of the lattice does not fit. `format`, `name`: of the file, for the message.
void check_32_bit_indices(const Lattice& lattice, std::string_view format, const std::string& name);

}  // namespace raycone
