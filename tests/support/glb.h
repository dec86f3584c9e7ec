// glTF documents in one binary file.
#pragma once

#include <cstdint>
#include <string>

namespace raycone::test {

inline std::string little_endian(std::uint32_t value) {
  return {static_cast<char>(value & 255), static_cast<char>(value >> 8 & 255), static_cast<char>(value >> 16 & 255),
          static_cast<char>(value >> 24)};
}

inline std::string glb_chunk(const char* type, std::string data, char padding) {
  while (data.size() % 4 != 0) data += padding;
  return little_endian(static_cast<std::uint32_t>(data.size())) + std::string(type, 4) + data;
}

// Without a second chunk where `binary` is empty.
inline std::string glb(const std::string& json, const std::string& binary) {
  const std::string chunks = glb_chunk("JSON", json, ' ') + (binary.empty() ? "" : glb_chunk("BIN\0", binary, '\0'));
  return "glTF" + little_endian(2) + little_endian(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

}  // namespace raycone::test
