// Recognition of mesh formats by the first bytes of a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "io/mesh/read_mesh.h"

namespace raycone {

// The format whose signature the bytes carry; absent for OBJ, which has none, and for what is none of the others.
[[nodiscard]] std::optional<MeshFormat> recognise_mesh(std::string_view bytes);

// The keyword at the start of `text`, "OFF" with its prefixes ("OFF", "COFF", "STCN4OFF"); empty where there is none.
[[nodiscard]] std::string_view off_keyword(std::string_view text);

// Binary STL: a header of any 80 bytes, a little-endian number of triangles, 50 bytes for each.
inline constexpr std::uint64_t kStlHeaderSize = 84;
inline constexpr std::uint64_t kStlTriangleSize = 50;

// The number of triangles that a binary STL announces; absent where the bytes are too few for one.
[[nodiscard]] std::optional<std::uint32_t> announced_stl_triangles(std::string_view bytes);

// Whether these are the bytes of an ASCII STL rather than a binary one, whose header may start with "solid" too.
[[nodiscard]] bool is_ascii_stl(std::string_view bytes);

}  // namespace raycone
