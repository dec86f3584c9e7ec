// Numbers in the byte order of files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>

namespace raycone {

// The number stored at `bytes`, which need not be aligned.
template <class Number>
[[nodiscard]] Number load(const char* bytes, std::endian order) {
  std::array<char, sizeof(Number)> copy;
  std::copy_n(bytes, sizeof(Number), copy.begin());
  if (order != std::endian::native) std::reverse(copy.begin(), copy.end());
  return std::bit_cast<Number>(copy);
}

template <class Number>
[[nodiscard]] Number load_little_endian(const char* bytes) {
  return load<Number>(bytes, std::endian::little);
}

}  // namespace raycone
