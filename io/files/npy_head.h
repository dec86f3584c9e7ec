// What precedes the elements of an NPY file, versions 1 to 3 (NumPy documentation, "numpy.lib.format").
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/input_buffer.h"

namespace raycone {

inline constexpr std::string_view kNpyMagic = "\x93NUMPY";

struct NpyHead {
  std::string type;  // as NumPy writes it, "<f8" for instance, or of structured values a list of names and types
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
  std::string shape_text;
  std::uint64_t data_offset = 0;
};

// Consumes the head. Throws InputError.
[[nodiscard]] NpyHead read_npy_head(InputBuffer& input);

// A head of version 1.0 to write, for elements in C order: a text padded to 64 bytes. `descriptor`: of the elements,
// "<f8" for instance; `shape`: as Python writes a tuple. For one axis it has the same length whatever the count.
[[nodiscard]] std::string npy_head(const std::string& descriptor, const std::string& shape);

// Waits until `count` bytes are pending; throws InputError where the input ends before.
void require_bytes(InputBuffer& input, std::size_t count, const char* what);

}  // namespace raycone
