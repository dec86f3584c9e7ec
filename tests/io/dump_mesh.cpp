// What read_mesh makes of files, for comparison with what others make of them (read_mesh_oracle_test.py).
//
// Reads paths, one a line, from standard input. Writes for each one line: "error MESSAGE", or "mesh", the number of
// warnings, and the nine coordinates of every triangle as hexadecimal floating-point numbers. With --cut concave
// polygons are cut as the tool does.
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "core/mesh/polygons.h"
#include "io/mesh/read_mesh.h"

namespace {

void dump(const std::string& path, bool cut) {
  raycone::ParsedMesh parsed = raycone::read_mesh(path).parsed;
  if (cut) raycone::cut_concave_polygons(parsed.mesh, parsed.polygons);
  std::printf("mesh %zu", parsed.warnings.size());
  for (const raycone::Triangle& triangle : parsed.mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const raycone::Vec3& p = parsed.mesh.vertices[corner];
      std::printf(" %a %a %a", p.x, p.y, p.z);
    }
  }
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  const bool cut = argc > 1 && std::string(argv[1]) == "--cut";
  for (std::string path; std::getline(std::cin, path);) {
    try {
      dump(path, cut);
    } catch (const std::exception& error) {
      std::printf("error %s\n", error.what());
    }
    std::fflush(stdout);
  }
}
