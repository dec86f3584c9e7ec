#include "io/mesh/write_ply.h"

#include <limits>
#include <string>

#include "io/files/file_error.h"

namespace raycone {
namespace {

std::string header_of(const ColouredMesh& mesh) {
  const std::string colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return "ply\nformat binary_little_endian 1.0\ncomment made by raycone\nelement vertex " +
         std::to_string(mesh.vertices.size()) + "\nproperty double x\nproperty double y\nproperty double z\n" + colour +
         "element face " + std::to_string(mesh.faces.size()) + "\nproperty list uchar int vertex_indices\n" + colour +
         "element edge " + std::to_string(mesh.edges.size()) + "\nproperty int vertex1\nproperty int vertex2\n" +
         colour + "end_header\n";
}

template <class Number>
void put(OutputFile& output, Number number) {
  output.write(&number, sizeof number);
}

void put(OutputFile& output, const Colour& colour) { output.write(colour.data(), colour.size()); }

}  // namespace

void write_ply(OutputFile& output, const ColouredMesh& mesh) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (mesh.vertices.size() > kMost) {
    throw LimitError(output.name() + ": needs " + std::to_string(mesh.vertices.size()) +
                     " vertices, but PLY files have up to " + std::to_string(kMost));
  }
  const std::string header = header_of(mesh);
  output.write(header.data(), header.size());
  for (const auto& [position, colour] : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) put(output, position[axis]);
    put(output, colour);
  }
  for (const auto& [corners, colour] : mesh.faces) {
    put(output, std::uint8_t{3});
    for (const std::uint32_t corner : corners) put(output, corner);
    put(output, colour);
  }
  for (const auto& [ends, colour] : mesh.edges) {
    for (const std::uint32_t end : ends) put(output, end);
    put(output, colour);
  }
  output.commit();
}

}  // namespace raycone
