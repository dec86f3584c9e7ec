// Counts of edges, faces and components, and the volume, against their definitions on meshes with every kind of defect.
#include "core/mesh/mesh_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/machine/threads.h"
#include "core/mesh/edge_uses.h"
#include "core/mesh/exterior_edges.h"
#include "tests/support/exact_predicates.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the lower vertex first
struct Uses {
  std::uint32_t forward = 0, backward = 0;
  friend bool operator==(const Uses&, const Uses&) = default;
};

std::map<Edge, Uses> uses_by_definition(const TriangleMesh& mesh) {
  std::map<Edge, Uses> uses;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      if (from == to) continue;
      Uses& use = uses[std::minmax(from, to)];
      ++(from < to ? use.forward : use.backward);
    }
  }
  return uses;
}

std::map<Edge, Uses> uses_of(const TriangleMesh& mesh) {
  std::map<Edge, Uses> uses;
  for_each_edge(mesh, [&](const EdgeUse& use) {
    EXPECT_LT(use.low, use.high);
    EXPECT_TRUE(uses.emplace(Edge{use.low, use.high}, Uses{use.forward, use.backward}).second) << "visited twice";
  });
  return uses;
}

// Each face in turn takes over all components that it touches.
std::uint64_t components_by_definition(const TriangleMesh& mesh) {
  std::vector<std::set<std::uint32_t>> components;
  for (const Triangle& t : mesh.triangles) {
    std::set<std::uint32_t> joined(t.begin(), t.end());
    std::erase_if(components, [&](const std::set<std::uint32_t>& one) {
      const bool touches = std::ranges::any_of(t, [&](std::uint32_t v) { return one.contains(v); });
      if (touches) joined.insert(one.begin(), one.end());
      return touches;
    });
    components.push_back(std::move(joined));
  }
  return components.size();
}

std::uint64_t duplicates_by_definition(const TriangleMesh& mesh) {
  std::set<std::multiset<std::uint32_t>> seen;
  for (const Triangle& t : mesh.triangles) seen.insert(std::multiset<std::uint32_t>(t.begin(), t.end()));
  return mesh.triangles.size() - seen.size();
}

// Indices at random: equal corners, faces in either orientation and several times, unused vertices.
TriangleMesh any_faces(test::Random& random, std::uint32_t vertices, std::size_t faces) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    mesh.vertices.push_back(test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
  }
  for (std::size_t i = 0; i < faces; ++i) {
    Triangle t{};
    for (std::uint32_t& v : t) v = static_cast<std::uint32_t>(random() % vertices);
    mesh.triangles.push_back(t);
    if (random() % 8 == 0) mesh.triangles.push_back({t[1], t[0], t[2]});
    if (random() % 8 == 0) mesh.triangles.push_back({t[1], t[2], t[0]});
  }
  return mesh;
}

TEST(MeshStatistics, AreWhatTheirDefinitionsSay) {
  test::Random random(1);
  std::uint64_t inconsistent = 0, nonmanifold = 0, duplicate = 0, degenerate = 0, several_components = 0;
  for (int i = 0; i < 400; ++i) {
    const auto vertices = static_cast<std::uint32_t>(3 + random() % 60);
    const TriangleMesh mesh =
        i % 4 == 0 ? test::lattice_soup(random, 30, 2) : any_faces(random, vertices, 1 + random() % 40);
    const std::map<Edge, Uses> uses = uses_by_definition(mesh);
    ASSERT_EQ(uses_of(mesh), uses);
    MeshStatistics expected;
    for (const auto& [edge, use] : uses) {
      expected.exterior_edges += use.forward != use.backward;
      expected.inconsistent_edges += use.forward + use.backward == 2 && use.forward != 1;
      expected.nonmanifold_edges += use.forward + use.backward > 2;
    }
    for (const Triangle& t : mesh.triangles) {
      expected.degenerate_faces +=
          test::exactly_collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    }
    const MeshStatistics s = mesh_statistics(mesh);
    ASSERT_EQ(s.exterior_edges, expected.exterior_edges);
    ASSERT_EQ(s.exterior_edges, exterior_edges(mesh).size());
    ASSERT_EQ(s.inconsistent_edges, expected.inconsistent_edges);
    ASSERT_EQ(s.nonmanifold_edges, expected.nonmanifold_edges);
    ASSERT_EQ(s.degenerate_faces, expected.degenerate_faces);
    ASSERT_EQ(s.duplicate_faces, duplicates_by_definition(mesh));
    ASSERT_EQ(s.components, components_by_definition(mesh));
    ASSERT_EQ(s.signed_volume.has_value(), s.closed());
    inconsistent += s.inconsistent_edges;
    nonmanifold += s.nonmanifold_edges;
    duplicate += s.duplicate_faces;
    degenerate += s.degenerate_faces;
    several_components += s.components > 1;
  }
  // Else the meshes have lost their point.
  EXPECT_GT(inconsistent, 100U);
  EXPECT_GT(nonmanifold, 100U);
  EXPECT_GT(duplicate, 100U);
  EXPECT_GT(degenerate, 100U);
  EXPECT_GT(several_components, 50U);
}

// Vertices of one bucket and of several, edges between the first and the last, and one edge of very many faces.
TEST(EdgeUses, OfLargeMeshesAreThoseOfTheirDefinition) {
  test::Random random(2);
  TriangleMesh mesh = any_faces(random, 30'000, 20'000);
  for (std::uint32_t i = 2; i < 5000; ++i) mesh.triangles.push_back(i % 3 == 0 ? Triangle{1, 0, i} : Triangle{0, 1, i});
  mesh.triangles.push_back({0, 29'999, 4096});
  mesh.triangles.push_back({4095, 4096, 4097});
  EXPECT_EQ(uses_of(mesh), uses_by_definition(mesh));
}

TEST(ExteriorEdges, DoNotDependOnThreads) {
  test::Random random(3);
  const TriangleMesh mesh = any_faces(random, 900, 3000);
  const auto edges = [&] {
    std::vector<std::array<std::int64_t, 3>> all;
    for (const ExteriorEdge& e : exterior_edges(mesh)) all.push_back({e.from, e.to, e.multiplicity});
    return all;
  };
  const auto expected = edges();
  EXPECT_GT(expected.size(), 1000U);
  for (const int threads : {1, 2, 3, 7, 16}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(edges(), expected) << threads;
  }
}

// The tetrahedra from the origin, in 3000 bits.
double volume_by_definition(const TriangleMesh& mesh) {
  using Real =
      boost::multiprecision::number<boost::multiprecision::cpp_bin_float<3000, boost::multiprecision::digit_base_2>,
                                    boost::multiprecision::et_off>;
  Real sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += Real(a.x) * (Real(b.y) * c.z - Real(b.z) * c.y) + Real(a.y) * (Real(b.z) * c.x - Real(b.x) * c.z) +
           Real(a.z) * (Real(b.x) * c.y - Real(b.y) * c.x);
  }
  return static_cast<double>(Real(sum / 6));
}

TEST(MeshStatistics, VolumeIsThatOfItsTetrahedraAtEveryMagnitude) {
  test::Random random(4);
  for (const double size : {1e-107, 1e-90, 1e-30, 1.0, 1e30, 1e90, 1e102}) {
    for (const Vec3& shift : {Vec3{0, 0, 0}, Vec3{5e5, 4.6e6, -120}}) {
      for (const TriangleMesh& shape :
           {test::sphere(7), test::random_cells(random, 3), test::reversed(test::sphere(5))}) {
        const TriangleMesh mesh = test::moved(shape, {size, size, size}, size * shift);
        const double expected = volume_by_definition(mesh), actual = mesh_statistics(mesh).signed_volume.value();
        // Differences to the middle of the box and its rounding, which moves all tetrahedra alike: some u of the
        // volume.
        EXPECT_NEAR(actual, expected, std::abs(expected) * 1e-14 + std::numeric_limits<double>::denorm_min()) << size;
      }
    }
  }
}

TEST(MeshStatistics, VolumeBelowDoublesIsZeroWithoutASign) {
  for (const double size : {1e-120, 1e-300}) {
    const TriangleMesh box = test::box_mesh({0, 0, 0}, {size, size, size});
    for (const TriangleMesh& mesh : {box, test::reversed(box)}) {
      const double volume = mesh_statistics(mesh).signed_volume.value();
      EXPECT_EQ(volume, 0.0);
      EXPECT_FALSE(std::signbit(volume)) << size;
    }
  }
}

TEST(MeshStatistics, VolumeBeyondDoublesIsInfiniteWithItsSign) {
  for (const double size : {1e110, 1e200, 1e308}) {
    const TriangleMesh box = test::moved(test::box_mesh({-1, -1, -1}, {1, 1, 1}), {size, size, size}, {});
    EXPECT_EQ(mesh_statistics(box).signed_volume.value(), HUGE_VAL) << size;
    EXPECT_EQ(mesh_statistics(test::reversed(box)).signed_volume.value(), -HUGE_VAL) << size;
  }
}

TEST(MeshStatistics, OfAFan) {
  // Five triangles on one edge, three of them in one direction: the edge is non-manifold, net count 1.
  const MeshStatistics s = mesh_statistics(test::fan(5, 3));
  EXPECT_EQ(s.nonmanifold_edges, 1U);
  EXPECT_EQ(s.exterior_edges, 11U);
  EXPECT_EQ(s.inconsistent_edges, 0U);
  EXPECT_EQ(s.components, 1U);
  EXPECT_FALSE(s.closed());
  EXPECT_FALSE(s.signed_volume.has_value());
}

TEST(MeshStatistics, TwoFacesInTheSameDirectionAreInconsistent) {
  EXPECT_EQ(mesh_statistics(test::fan(2, 2)).inconsistent_edges, 1U);
  EXPECT_EQ(mesh_statistics(test::fan(2, 1)).inconsistent_edges, 0U);
}

TEST(MeshStatistics, VolumeOfABoxFarFromTheOriginHasTheSignOfItsOrientation) {
  const TriangleMesh box = test::box_mesh({1e6, 1e6, 1e6}, {1e6 + 2, 1e6 + 3, 1e6 + 4});
  EXPECT_DOUBLE_EQ(mesh_statistics(box).signed_volume.value(), 24.0);
  EXPECT_DOUBLE_EQ(mesh_statistics(test::reversed(box)).signed_volume.value(), -24.0);
}

TEST(MeshStatistics, CountsDegenerateAndDuplicateFaces) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {0, 1, 0}},
                          {{0, 1, 2}, {0, 1, 3}, {3, 1, 0}, {1, 3, 0}, {0, 0, 3}}};
  const MeshStatistics s = mesh_statistics(mesh);
  EXPECT_EQ(s.degenerate_faces, 2U);
  EXPECT_EQ(s.duplicate_faces, 2U);
}

TEST(MeshStatistics, ComponentsAreJoinedThroughVertices) {
  const TriangleMesh a = test::box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(mesh_statistics(test::joined(a, test::box_mesh({1, 1, 1}, {2, 2, 2}))).components, 1U);
  EXPECT_EQ(mesh_statistics(test::joined(a, test::box_mesh({1.5, 1, 1}, {2, 2, 2}))).components, 2U);
}

}  // namespace
}  // namespace raycone
