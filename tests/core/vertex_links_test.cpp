// What is noted at vertices leads to the same components as the triangles, and to faces that cancel by their
// definition.
#include "core/mesh/vertex_links.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <utility>

#include "core/mesh/components.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/opposite_faces.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

VertexLinks links_of(const TriangleMesh& mesh) {
  VertexLinks links(mesh.vertices.size());
  static_cast<void>(exterior_edges(mesh, &links));
  return links;
}

// Pairs of opposite orientations among the faces of three vertices each.
std::size_t pairs_by_definition(const TriangleMesh& mesh) {
  std::map<Triangle, std::array<std::size_t, 2>> faces;  // by the rotation that begins with the lowest vertex
  for (const Triangle& t : mesh.triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    Triangle rotated = t;
    std::ranges::rotate(rotated, std::ranges::min_element(rotated));
    const bool swapped = rotated[1] > rotated[2];
    if (swapped) std::swap(rotated[1], rotated[2]);
    ++faces[rotated][swapped ? 1 : 0];
  }
  std::size_t pairs = 0;
  for (const auto& [face, counts] : faces) pairs += std::min(counts[0], counts[1]);
  return pairs;
}

// Few vertices, so that faces share them, with equal corners among them, and some that no face uses.
TriangleMesh random_faces(Random& random, std::uint32_t vertices, int faces) {
  TriangleMesh mesh;
  mesh.vertices.resize(vertices);
  std::uniform_int_distribution<std::uint32_t> any(0, vertices - 1);
  for (int i = 0; i < faces; ++i) mesh.triangles.push_back({any(random), any(random), any(random)});
  return mesh;
}

TEST(VertexLinks, LeadToTheComponentsOfTheTriangles) {
  Random random(41);
  for (int i = 0; i < 300; ++i) {
    const TriangleMesh mesh = random_faces(random, 1 + static_cast<std::uint32_t>(i), 1 + (7 * i) % 120);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, i % 2 == 0 ? 1 : 8);
    const Components expected = components_of(mesh), found = components_of(mesh, links_of(mesh));
    ASSERT_EQ(found.count, expected.count) << "mesh " << i;
    ASSERT_EQ(found.of_vertex, expected.of_vertex) << "mesh " << i;
  }
}

TEST(VertexLinks, LeadToTheFacesThatCancel) {
  Random random(43);
  std::size_t pairs = 0;
  for (int i = 0; i < 300; ++i) {
    const TriangleMesh mesh = random_faces(random, 3 + static_cast<std::uint32_t>(i % 9), 1 + (7 * i) % 120);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, i % 2 == 0 ? 1 : 8);
    const std::size_t expected = pairs_by_definition(mesh);
    ASSERT_EQ(opposite_faces(mesh, links_of(mesh)).size(), 2 * expected) << "mesh " << i;
    pairs += expected;
  }
  EXPECT_GT(pairs, 100U);
}

}  // namespace
}  // namespace raycone::test
