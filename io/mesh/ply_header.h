// The header of a PLY file: what its body holds, in which encoding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/text_scanner.h"

namespace raycone {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

enum class PlyScalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

inline constexpr std::array<std::string_view, 3> kPlyCoordinates = {"x", "y", "z"};

// Calls use(number) with a number of the C++ type that `type` stands for; its value means nothing.
template <class Use>
auto with_type(PlyScalar type, Use use) {
  switch (type) {
    case PlyScalar::kInt8:
      return use(std::int8_t{});
    case PlyScalar::kUint8:
      return use(std::uint8_t{});
    case PlyScalar::kInt16:
      return use(std::int16_t{});
    case PlyScalar::kUint16:
      return use(std::uint16_t{});
    case PlyScalar::kInt32:
      return use(std::int32_t{});
    case PlyScalar::kUint32:
      return use(std::uint32_t{});
    case PlyScalar::kFloat32:
      return use(float{});
    case PlyScalar::kFloat64:
      break;
  }
  return use(double{});
}

// Bytes of a scalar in a binary body.
[[nodiscard]] inline std::size_t size_of(PlyScalar type) {
  return with_type(type, [](auto number) { return sizeof(number); });
}

struct PlyProperty {
  std::string name;
  PlyScalar type;
  std::optional<PlyScalar> count_type;  // of a list: the type of its length

  [[nodiscard]] bool is_list() const { return count_type.has_value(); }
};

// A table: `count` rows of the properties, in their order.
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Null where there is none of that name.
  [[nodiscard]] const PlyProperty* find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::uint64_t unknown_lines = 0;  // that begin with no keyword of the format
  std::size_t vertex_element = 0;   // index of the one named "vertex", which has the numbers "x", "y" and "z"
};

// Reads the header and leaves `text` at the first byte of the body. Throws InputError.
[[nodiscard]] PlyHeader read_ply_header(TextScanner& text);

}  // namespace raycone
