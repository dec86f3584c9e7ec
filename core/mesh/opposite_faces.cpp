#include "core/mesh/opposite_faces.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace raycone {
namespace {

bool has_three_vertices(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

// Bit 0 to 63, the same one for faces of the same vertices in whatever order. Squares, because sums of the numbers
// themselves are equal all over a regular mesh.
unsigned bit_of(const Triangle& t) {
  const auto square = [](std::uint64_t v) { return v * v; };
  return static_cast<unsigned>((square(t[0]) + square(t[1]) + square(t[2])) * 0x9E3779B97F4A7C15 >> 58);
}

std::uint32_t lowest_vertex(const Triangle& t) { return std::min({t[0], t[1], t[2]}); }

// Lowest vertices of faces that may have a twin. Few faces share a lowest vertex, so that 64 bits tell them apart; and
// neighbouring vertices are near each other in memory, which a hash table of the faces would not be.
std::vector<bool> vertices_with_twins(const TriangleMesh& mesh) {
  std::vector<std::uint64_t> seen(mesh.vertices.size(), 0);
  std::vector<bool> twins(mesh.vertices.size(), false);
  constexpr std::size_t kAhead = 16;  // triangles: their vertices may be anywhere in memory
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (i + kAhead < mesh.triangles.size()) __builtin_prefetch(&seen[lowest_vertex(mesh.triangles[i + kAhead])], 1);
    const Triangle& t = mesh.triangles[i];
    const std::uint32_t low = lowest_vertex(t);
    const std::uint64_t bit = std::uint64_t{1} << bit_of(t);
    if ((seen[low] & bit) != 0) twins[low] = true;
    seen[low] |= bit;
  }
  return twins;
}

// A face by its vertices, whether they are in increasing order but for a rotation, and its number.
struct FaceKey {
  std::array<std::uint32_t, 3> corners;
  bool increasing;
  std::uint32_t face;
};

FaceKey key_of(const Triangle& t, std::size_t face) {
  const auto low = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  const std::uint32_t next = t[(low + 1) % 3], last = t[(low + 2) % 3];
  return {{t[low], std::min(next, last), std::max(next, last)}, next < last, static_cast<std::uint32_t>(face)};
}

}  // namespace

std::vector<std::uint32_t> opposite_faces(const TriangleMesh& mesh) {
  const std::vector<bool> twins = vertices_with_twins(mesh);
  std::vector<FaceKey> keys;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (twins[lowest_vertex(t)] && has_three_vertices(t)) keys.push_back(key_of(t, i));
  }
  std::ranges::sort(keys, {}, [](const FaceKey& key) { return std::tie(key.corners, key.increasing, key.face); });
  std::vector<std::uint32_t> faces;
  for (auto begin = keys.begin(); begin != keys.end();) {
    const auto end = std::find_if(begin, keys.end(), [&](const FaceKey& key) { return key.corners != begin->corners; });
    const auto increasing = std::find_if(begin, end, [](const FaceKey& key) { return key.increasing; });
    const auto pairs = std::min(increasing - begin, end - increasing);
    for (std::ptrdiff_t n = 0; n < pairs; ++n) {
      faces.push_back(begin[n].face);
      faces.push_back(increasing[n].face);
    }
    begin = end;
  }
  std::ranges::sort(faces);
  return faces;
}

}  // namespace raycone
