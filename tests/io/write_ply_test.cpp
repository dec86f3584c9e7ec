// Coloured PLY files, read back by our own reader and by eye.
#include "io/mesh/write_ply.h"

#include <gtest/gtest.h>

#include <string>

#include "io/mesh/read_mesh.h"
#include "tests/support/output_checks.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/text_files.h"

namespace raycone {
namespace {

using test::read_text;
using test::TemporaryDirectory;

ColouredMesh example() {
  ColouredMesh mesh;
  mesh.vertices = {{{0, 0, 0}, {1, 2, 3}}, {{0.1, 0, 0}, {4, 5, 6}}, {{0, 1e300, -5e-324}, {7, 8, 9}}};
  mesh.faces = {{{2, 0, 1}, {10, 11, 12}}};
  mesh.edges = {{{0, 2}, {13, 14, 255}}};
  return mesh;
}

std::string written(const ColouredMesh& mesh, const std::string& path) {
  OutputFile output(path);
  write_ply(output, mesh);
  return read_text(path);
}

TEST(WritePly, KeepsPositionsAndFaces) {
  const TemporaryDirectory directory;
  const ColouredMesh mesh = example();
  (void)written(mesh, directory / "mesh.ply");
  const MeshFile file = read_mesh(directory / "mesh.ply", {});
  ASSERT_EQ(file.parsed.mesh.vertices.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(file.parsed.mesh.vertices[i], mesh.vertices[i].position);
  EXPECT_EQ(file.parsed.mesh.triangles, std::vector<Triangle>{mesh.faces[0].corners});
}

TEST(WritePly, StoresColoursAndEdges) {
  const TemporaryDirectory directory;
  const std::string bytes = written(example(), directory / "mesh.ply");
  const std::string header_end = "end_header\n";
  const std::size_t data = bytes.find(header_end) + header_end.size();
  EXPECT_NE(bytes.find("element edge 1\nproperty int vertex1\nproperty int vertex2\nproperty uchar red"),
            std::string::npos);
  // Vertices of 27 bytes, a face of 16, an edge of 11.
  ASSERT_EQ(bytes.size(), data + 3 * 27 + 16 + 11);
  EXPECT_EQ(bytes.substr(data + 27 + 24, 3), "\x04\x05\x06");
  EXPECT_EQ(bytes.substr(data + 81, 16), std::string("\x03\2\0\0\0\0\0\0\0\1\0\0\0\x0a\x0b\x0c", 16));
  EXPECT_EQ(bytes.substr(data + 97), std::string("\0\0\0\0\2\0\0\0\x0d\x0e\xff", 11));
}

}  // namespace
}  // namespace raycone
