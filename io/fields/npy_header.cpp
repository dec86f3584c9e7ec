#include "io/fields/npy_header.h"

#include <cstddef>

namespace raycone {

std::string npy_header(const std::string& descriptor, const std::string& shape) {
  constexpr std::size_t kAlignment = 64;
  constexpr std::size_t kPreamble = 10;  // magic, version, length
  std::string text = "{'descr': '" + descriptor + "', 'fortran_order': False, 'shape': " + shape + ", }";
  const std::size_t total = (kPreamble + text.size() + 1 + kAlignment - 1) / kAlignment * kAlignment;
  text.append(total - kPreamble - text.size() - 1, ' ');
  text += '\n';
  const auto low = static_cast<char>(text.size() & 0xFF);
  const auto high = static_cast<char>(text.size() >> 8);
  return std::string("\x93NUMPY\x01") + '\0' + low + high + text;
}

}  // namespace raycone
