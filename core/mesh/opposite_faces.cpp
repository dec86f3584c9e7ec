#include "core/mesh/opposite_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

namespace raycone {
namespace {

// Equal for faces of the same vertices in whatever order.
std::size_t hash_of(const Triangle& t) {
  const auto square = [](std::uint64_t v) { return v * v; };
  return (square(t[0]) + square(t[1]) + square(t[2])) * 0x9E3779B97F4A7C15 >> 24;
}

// The faces of which another one may have the same vertices, nearly all of which have.
std::vector<std::uint32_t> candidates(const TriangleMesh& mesh, const VertexLinks& links) {
  if (links.twins().empty()) return {};
  std::vector<std::uint8_t> twins(mesh.vertices.size(), 0);
  for (const std::uint32_t v : links.twins()) twins[v] = 1;
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (twins[VertexLinks::lowest_of(mesh.triangles[i])] != 0) faces.push_back(static_cast<std::uint32_t>(i));
  }
  constexpr std::size_t kPlaces = 32;  // per face: more would leave the cache
  const std::size_t mask = std::bit_ceil(kPlaces * faces.size()) - 1;
  std::vector<bool> met(mask + 1, false), met_twice(mask + 1, false);
  for (const std::uint32_t face : faces) {
    const std::size_t place = hash_of(mesh.triangles[face]) & mask;
    if (met[place]) met_twice[place] = true;
    met[place] = true;
  }
  std::erase_if(faces, [&](std::uint32_t face) {
    const Triangle& t = mesh.triangles[face];
    return !met_twice[hash_of(t) & mask] || is_collapsed(t);
  });
  return faces;
}

// A face by its vertices, whether they are in increasing order but for a rotation, and its number.
struct FaceKey {
  std::array<std::uint32_t, 3> corners;
  bool increasing;
  std::uint32_t face;
};

FaceKey key_of(const Triangle& t, std::uint32_t face) {
  const auto low = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  const std::uint32_t next = t[(low + 1) % 3], last = t[(low + 2) % 3];
  return {{t[low], std::min(next, last), std::max(next, last)}, next < last, face};
}

}  // namespace

std::vector<std::uint32_t> opposite_faces(const TriangleMesh& mesh, const VertexLinks& links) {
  std::vector<FaceKey> keys;
  for (const std::uint32_t face : candidates(mesh, links)) keys.push_back(key_of(mesh.triangles[face], face));
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
