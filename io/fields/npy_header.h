// The head of NPY, NumPy's array files, format version 1.0 (NEP 1).
#pragma once

#include <string>

namespace raycone {

// What precedes the elements, in C order: a text padded to 64 bytes. `descriptor`: of the elements, "<f8" for instance;
// `shape`: as Python writes a tuple. For one axis the header has the same length whatever the count.
[[nodiscard]] std::string npy_header(const std::string& descriptor, const std::string& shape);

}  // namespace raycone
