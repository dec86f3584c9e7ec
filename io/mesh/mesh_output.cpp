#include "io/mesh/mesh_output.h"

#include <cstdint>
#include <limits>

#include "io/files/file_error.h"

namespace raycone {

void check_vertex_count(const OutputFile& output, std::size_t vertices) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (vertices <= kMost) return;
  throw LimitError(output.name() + ": needs " + std::to_string(vertices) + " vertices, but mesh files have up to " +
                   std::to_string(kMost));
}

std::string ply_head(std::size_t vertices, const std::string& vertex_properties, std::size_t faces,
                     const std::string& face_properties, const std::string& elements) {
  return "ply\nformat binary_little_endian 1.0\ncomment made by raycone\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\n" + vertex_properties + "element face " +
         std::to_string(faces) + "\nproperty list uchar int vertex_indices\n" + face_properties + elements +
         "end_header\n";
}

}  // namespace raycone
