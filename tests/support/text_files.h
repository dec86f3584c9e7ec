// Files as text, byte by byte.
#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace raycone::test {

// Empty where there is no such file.
inline std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace raycone::test
