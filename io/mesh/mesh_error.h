// Wording of errors that the mesh readers share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "io/files/counted.h"
#include "io/files/file_error.h"

namespace raycone {

// As many as indices of 32 bits tell apart.
inline constexpr std::size_t kMaxVertices = 0xFFFFFFFF;

// Throws LimitError.
[[noreturn]] inline void fail_too_many_vertices(const std::string& name) {
  throw LimitError(name + ": more than " + std::to_string(kMaxVertices) +
                   " vertices, which 32-bit indices cannot address");
}

inline constexpr const char* kNonFiniteCorner =
    "a vertex that faces use has a coordinate that is not finite, expected finite numbers";

// "1 byte follows", "2 bytes follow"
[[nodiscard]] inline std::string remaining_bytes(std::uint64_t count) {
  return counted(count, "byte") + (count == 1 ? " follows" : " follow");
}

// For formats that count vertices from 0.
[[nodiscard]] inline std::string index_out_of_range(std::int64_t index, std::uint64_t vertices) {
  return "face index " + std::to_string(index) + ", but there " + (vertices == 1 ? "is" : "are") + " only " +
         counted(vertices, "vertex");
}

}  // namespace raycone
