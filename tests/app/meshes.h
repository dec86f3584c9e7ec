// Small meshes as text, for tests of the command line.
#pragma once

#include <random>
#include <sstream>
#include <string>

#include "core/data/triangle_mesh.h"
#include "tests/support/bytes.h"
#include "tests/support/text_files.h"

namespace raycone::test {

// The cube [0, 1]^3, closed, outward.
inline const char* const kCube = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

// With all digits.
inline std::string obj_of(const TriangleMesh& mesh) {
  std::ostringstream obj;
  obj.precision(17);
  for (const Vec3& p : mesh.vertices) obj << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const Triangle& t : mesh.triangles) obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return obj.str();
}

// The triangle (0, 0, 0), (1, 0, 0), (0, 1, 0): flat along z, open.
inline const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

// A triangle as glTF, whose corners are in the file `uri`: triangle_corners().
inline std::string gltf_of(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scene":0,"scenes":[{"nodes":[0]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
         uri + "\"}]}";
}

inline std::string triangle_corners(float size) { return bytes_of<float>({0, 0, 0, size, 0, 0, 0, size, 0}); }

// Unconnected triangles in the unit cube: each has three exterior edges.
inline std::string triangle_soup(int triangles) {
  std::mt19937 random(1);
  const auto coordinate = [&random] { return static_cast<double>(random()) * 0x1p-32; };
  std::ostringstream obj;
  for (int i = 0; i < 3 * triangles; ++i) {
    obj << "v " << coordinate() << ' ' << coordinate() << ' ' << coordinate() << '\n';
  }
  for (int i = 0; i < triangles; ++i) obj << "f " << 3 * i + 1 << ' ' << 3 * i + 2 << ' ' << 3 * i + 3 << '\n';
  return obj.str();
}

}  // namespace raycone::test
