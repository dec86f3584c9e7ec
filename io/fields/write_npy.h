// NPY of values that are neither a lattice's nor points'.
#pragma once

#include <cstdint>
#include <span>

#include "io/files/output_file.h"

namespace raycone {

// Writes a float64 array of shape (rows, columns), C order, and commits. Throws OutputError. Precondition:
// values.size() is their product.
void write_npy_rows(OutputFile& output, std::int64_t rows, std::int64_t columns, std::span<const double> values);

}  // namespace raycone
