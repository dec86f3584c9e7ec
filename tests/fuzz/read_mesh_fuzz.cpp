// libFuzzer target of one mesh reader, RAYCONE_READER (tests/fuzz/CMakeLists.txt): whatever the bytes, it returns a
// mesh that keeps the promises of io/mesh/read_mesh.h or throws InputError or LimitError. Cutting its polygons leaves
// their boundaries as they were.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh/polygons.h"
#include "io/files/file_error.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

using Reader = ParsedMesh(const NamedBytes&);
using ReaderOfSeveralFiles = ParsedMesh(const NamedBytes&, std::vector<FileRead>*);

[[maybe_unused]] ParsedMesh read(Reader* reader, const NamedBytes& source) { return reader(source); }
[[maybe_unused]] ParsedMesh read(ReaderOfSeveralFiles* reader, const NamedBytes& source) {
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

// Each group has a name that is not too long, and triangles.
void check(const FaceGroups& groups, std::size_t triangles) {
  if (groups.runs.empty()) return;
  if (groups.runs.front().first != 0 || groups.runs.back().first >= triangles) std::abort();
  std::uint32_t known = 0;
  for (std::size_t n = 0; n < groups.runs.size(); ++n) {
    if (n > 0 && groups.runs[n - 1].first >= groups.runs[n].first) std::abort();
    if (groups.runs[n].group > known) std::abort();
    known += groups.runs[n].group == known;
  }
  if (known != groups.names.size()) std::abort();
  for (const std::string& name : groups.names) {
    if (name.size() > kMostOfName) std::abort();
  }
}

using Position = std::array<double, 3>;

// How often each edge is run along from its smaller end to the larger, less the other way.
std::map<std::pair<Position, Position>, int> boundary(const TriangleMesh& mesh) {
  std::map<std::pair<Position, Position>, int> net;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.vertices[triangle[i]], &b = mesh.vertices[triangle[(i + 1) % 3]];
      const Position from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      if (from < to) ++net[{from, to}];
      if (to < from) --net[{to, from}];
    }
  }
  std::erase_if(net, [](const auto& edge) { return edge.second == 0; });
  return net;
}

void check_polygons(ParsedMesh parsed) {
  const auto before = boundary(parsed.mesh);
  const std::uint64_t bad = cut_concave_polygons(parsed.mesh, parsed.polygons);
  if (bad > parsed.polygons.size()) std::abort();
  check(parsed.mesh);
  if (boundary(parsed.mesh) != before) std::abort();
}

}  // namespace
}  // namespace raycone

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    raycone::ParsedMesh parsed = raycone::read(raycone::RAYCONE_READER, {"fuzz", "", bytes});
    raycone::check(parsed.mesh);
    raycone::check(parsed.groups, parsed.mesh.triangles.size());
    raycone::check_polygons(std::move(parsed));
  } catch (const raycone::InputError&) {
  } catch (const raycone::LimitError&) {
  }
  return 0;
}
