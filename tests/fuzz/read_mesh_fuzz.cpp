// libFuzzer target of one mesh reader, RAYCONE_READER (tests/fuzz/CMakeLists.txt): whatever the bytes, it returns a
// mesh that keeps the promises of io/read_mesh.h or throws InputError or LimitError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_error.h"
#include "io/read_mesh.h"

namespace raycone {
namespace {

using Reader = ParsedMesh(const MeshSource&);
using ReaderOfSeveralFiles = ParsedMesh(const MeshSource&, std::vector<std::string>*);

[[maybe_unused]] ParsedMesh read(Reader* reader, const MeshSource& source) { return reader(source); }
[[maybe_unused]] ParsedMesh read(ReaderOfSeveralFiles* reader, const MeshSource& source) {
  std::vector<FileRead> companions;
  return reader(source, &companions);
}

void check(const TriangleMesh& mesh) {
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) std::abort();
      const Vec3& vertex = mesh.vertices[corner];
      if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) std::abort();
    }
  }
}

}  // namespace
}  // namespace raycone

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    raycone::check(raycone::read(raycone::RAYCONE_READER, {"fuzz", "", bytes}).mesh);
  } catch (const raycone::InputError&) {
  } catch (const raycone::LimitError&) {
  }
  return 0;
}
