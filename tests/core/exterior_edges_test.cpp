#include "core/mesh/exterior_edges.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/mesh/edge_uses.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using DirectedPair = std::tuple<double, double, double, double, double, double>;

DirectedPair key(const Vec3& a, const Vec3& b) { return {a.x, a.y, a.z, b.x, b.y, b.z}; }

// The boundary 1-chain by definition: for each directed pair of positions, how often triangles traverse it, net.
std::map<DirectedPair, int> chain_by_definition(const TriangleMesh& mesh) {
  std::map<DirectedPair, int> chain;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      ++chain[key(a, b)];
      --chain[key(b, a)];
    }
  }
  std::erase_if(chain, [](const auto& entry) { return entry.second == 0; });
  return chain;
}

std::map<DirectedPair, int> chain_of(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  std::map<DirectedPair, int> chain;
  for (const ExteriorEdge& e : edges) {
    chain[key(mesh.vertices[e.from], mesh.vertices[e.to])] += e.multiplicity;
    chain[key(mesh.vertices[e.to], mesh.vertices[e.from])] -= e.multiplicity;
  }
  return chain;
}

std::vector<DirectedPair> coordinates_in_order(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  std::vector<DirectedPair> keys;
  for (const ExteriorEdge& e : edges) keys.push_back(key(mesh.vertices[e.from], mesh.vertices[e.to]));
  return keys;
}

TEST(ExteriorEdges, OppositeTraversalsCancel) {
  EXPECT_TRUE(exterior_edges(test::box_mesh({0, 0, 0}, {1, 2, 3})).empty());
  EXPECT_EQ(exterior_edges(test::open_box()).size(), 4U);
}

TEST(ExteriorEdges, EqualTheBoundaryChainByDefinition) {
  test::Random random(1);
  for (int i = 0; i < 50; ++i) {
    const TriangleMesh mesh = test::lattice_soup(random, 1 + 3 * i, 3);  // many shared and multiple edges
    EXPECT_EQ(chain_of(mesh, exterior_edges(mesh)), chain_by_definition(mesh));
  }
}

TEST(ExteriorEdges, DuplicatedFacesGiveMultiplicityTwoAndOppositeOnesNone) {
  const TriangleMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  TriangleMesh twice = one, opposite = one;
  twice.triangles.push_back({1, 2, 0});
  opposite.triangles.push_back({0, 2, 1});
  for (const ExteriorEdge& e : exterior_edges(twice)) EXPECT_EQ(std::abs(e.multiplicity), 2);
  EXPECT_EQ(exterior_edges(twice).size(), 3U);
  EXPECT_TRUE(exterior_edges(opposite).empty());
}

TEST(ExteriorEdges, AreChainedSoThatNeighboursShareAVertex) {
  const std::vector<ExteriorEdge> edges = exterior_edges(test::open_box());
  ASSERT_EQ(edges.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(edges[i].from, edges[i - 1].to);
  EXPECT_EQ(edges[0].from, edges[3].to);
}

TEST(ExteriorEdges, OrderDependsOnCoordinatesOnly) {
  test::Random random(2);
  const TriangleMesh mesh = test::lattice_soup(random, 60, 3);
  const std::vector<DirectedPair> expected = coordinates_in_order(mesh, exterior_edges(mesh));
  for (int i = 0; i < 5; ++i) {
    const TriangleMesh other = test::shuffled(mesh, random);
    EXPECT_EQ(coordinates_in_order(other, exterior_edges(other)), expected);
  }
  const TriangleMesh reversed = test::reversed(mesh);
  EXPECT_EQ(coordinates_in_order(reversed, exterior_edges(reversed)), expected);
}

// More vertices than fit one piece of work, and vertices with very many edges.
TEST(ExteriorEdges, OfLargeMeshesAreTheirBoundaryChain) {
  test::Random random(12);
  const TriangleMesh mesh = test::joined(test::lattice_soup(random, 70'000, 24), test::lattice_soup(random, 500, 1));
  EXPECT_GT(mesh.vertices.size(), 15'000U);
  const std::vector<ExteriorEdge> edges = exterior_edges(mesh);
  EXPECT_EQ(chain_of(mesh, edges), chain_by_definition(mesh));
  std::pair<std::uint32_t, std::uint32_t> last{0, 0};
  for_each_edge(mesh, [&](const EdgeUse& use) {
    EXPECT_LT(last, std::pair(use.low, use.high));
    last = {use.low, use.high};
  });
}

}  // namespace
}  // namespace raycone
