#include "io/mesh/write_ply.h"

#include <string>

#include "io/mesh/mesh_output.h"

namespace raycone {
namespace {

std::string head_of(const ColouredMesh& mesh) {
  const std::string colour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string edges =
      "element edge " + std::to_string(mesh.edges.size()) + "\nproperty int vertex1\nproperty int vertex2\n" + colour;
  return ply_head(mesh.vertices.size(), colour, mesh.faces.size(), colour, edges);
}

}  // namespace

void write_ply(OutputFile& output, const ColouredMesh& mesh) {
  check_vertex_count(output, mesh.vertices.size());
  MeshOutput file(output);
  file.text(head_of(mesh));
  for (const auto& [position, colour] : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) file.binary(position[axis]);
    file.binary(colour);
  }
  for (const auto& [corners, colour] : mesh.faces) {
    file.binary(std::uint8_t{3});
    for (const std::uint32_t corner : corners) file.binary(corner);
    file.binary(colour);
  }
  for (const auto& [ends, colour] : mesh.edges) {
    for (const std::uint32_t end : ends) file.binary(end);
    file.binary(colour);
  }
  file.finish();
}

}  // namespace raycone
