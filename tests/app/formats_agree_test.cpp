// Values do not depend on the format of the file, nor on the order of faces, also on the surface. Black box: the real
// executable.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/bytes.h"
#include "tests/support/run_command.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// Coordinates are small integers: every format holds them exactly.

std::string vertices_and_faces(const TriangleMesh& mesh) {
  std::ostringstream text;
  for (const Vec3& v : mesh.vertices) text << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const Triangle& t : mesh.triangles) text << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  return text.str();
}

std::string as_off(const TriangleMesh& mesh) {
  return "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n" +
         vertices_and_faces(mesh);
}

std::string as_ply(const TriangleMesh& mesh) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices_and_faces(mesh);
}

std::string as_stl(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << "solid s\n";
  for (const Triangle& t : mesh.triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t i : t) {
      text << "vertex " << mesh.vertices[i].x << ' ' << mesh.vertices[i].y << ' ' << mesh.vertices[i].z << '\n';
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid s\n";
  return text.str();
}

// A .gltf whose buffer is `bin`, a file beside it.
std::string as_gltf(const TriangleMesh& mesh, const std::string& bin_path) {
  std::string bin;
  for (const Vec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) bin += bytes_of({static_cast<float>(v[axis])});
  }
  const std::size_t indices = bin.size();
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t i : t) bin += bytes_of({i});
  }
  write_text(bin_path, bin);
  const auto view = [](std::size_t offset, std::size_t length) {
    return nlohmann::json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}};
  };
  const Box box = bounding_box(mesh);
  const nlohmann::json document{
      {"asset", {{"version", "2.0"}}},
      {"buffers", {{{"uri", "mesh.bin"}, {"byteLength", bin.size()}}}},
      {"bufferViews", {view(0, indices), view(indices, bin.size() - indices)}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", mesh.vertices.size()},
         {"type", "VEC3"},
         {"min", {box.lower.x, box.lower.y, box.lower.z}},
         {"max", {box.upper.x, box.upper.y, box.upper.z}}},
        {{"bufferView", 1}, {"componentType", 5125}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"scenes", {{{"nodes", {0}}}}},
      {"scene", 0}};
  return document.dump();
}

// Samples at all half integers: on faces, edges and corners.
std::string values_of(const std::string& mesh) {
  const CommandResult result =
      run_raycone({"lattice", mesh, "-o", "-", "--voxel-size", "0.5", "--padding", "1v", "--diagnostics", "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  return result.out;
}

TEST(Formats, GiveTheSameValuesAndFlagsOnTheSurface) {
  const TemporaryDirectory dir;
  Random random(5);
  TriangleMesh mesh = random_cells(random, 4);
  mesh.triangles.resize(mesh.triangles.size() - 7);  // open
  write_text(dir / "mesh.obj", obj_of(mesh));
  write_text(dir / "shuffled.obj", obj_of(shuffled(mesh, random)));
  write_text(dir / "mesh.off", as_off(mesh));
  write_text(dir / "mesh.ply", as_ply(mesh));
  write_text(dir / "mesh.stl", as_stl(mesh));
  write_text(dir / "mesh.gltf", as_gltf(mesh, dir / "mesh.bin"));
  const std::string expected = values_of(dir / "mesh.obj");
  EXPECT_GT(std::ranges::count(csv_numbers(expected).column("on_surface"), 1.0), 100);
  for (const char* const file : {"shuffled.obj", "mesh.off", "mesh.ply", "mesh.stl", "mesh.gltf"}) {
    EXPECT_TRUE(values_of(dir / file) == expected) << file;
  }
  mesh.vertices[mesh.triangles[0][0]].x += 0.125;  // the comparison would notice another mesh
  write_text(dir / "other.obj", obj_of(mesh));
  EXPECT_FALSE(values_of(dir / "other.obj") == expected);
}

}  // namespace
}  // namespace raycone::test
