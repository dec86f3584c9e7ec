// On the surface: the value is that of the perturbed query, flagged, and depends on query and mesh alone.
#include <gtest/gtest.h>

#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/property/check.h"
#include "tests/support/diagnosed.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Diagnosed;
using test::Random;
using test::samples_of;

Diagnosed at_points(const TriangleMesh& mesh, const std::vector<Vec3>& queries, RayEngine engine = RayEngine::kScan) {
  return test::diagnosed(WindingNumberEvaluator(mesh, {.ray_engine = engine}), queries);
}

Diagnosed on_lattice(const TriangleMesh& mesh, const Lattice& lattice, RayEngine engine = RayEngine::kScan) {
  return test::diagnosed(WindingNumberEvaluator(mesh, {.ray_engine = engine}), lattice, whole(lattice));
}

// Half nodes of {0 .. 3}^3 and one more layer: on meshes with corners on the nodes most of them are vertices, middles
// of edges, or inside faces.
constexpr Lattice kHalfNodes{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {0, 0, 0}, {9, 9, 9}};

// Closed, open, and with faces that are duplicated, reversed and of zero area.
std::vector<TriangleMesh> meshes(Random& random) {
  TriangleMesh cancelling = test::joined(test::random_cells(random, 3), test::lattice_soup(random, 10, 3));
  for (std::size_t i = 0; i < 6; ++i) {
    const Triangle t = cancelling.triangles[5 * i];
    cancelling.triangles.push_back(i % 2 == 0 ? Triangle{t[0], t[2], t[1]} : Triangle{t[1], t[2], t[0]});
  }
  return {test::random_cells(random, 3), test::lattice_soup(random, 30, 3), cancelling};
}

TEST(OnSurface, IsFlaggedAndHasThePerturbedQuerysValue) {
  Random random(1);
  const std::vector<Vec3> queries = samples_of(kHalfNodes);
  std::vector<Vec3> some;  // the oracle takes milliseconds for each; a step of 4 would leave out all nodes
  for (std::size_t n = 0; n < queries.size(); n += 5) some.push_back(queries[n]);
  for (const TriangleMesh& mesh : meshes(random)) {
    const auto failure = test::check(mesh, some);
    EXPECT_FALSE(failure) << test::describe(mesh, *failure);
    EXPECT_GT(at_points(mesh, queries).tally.on_surface, 100U);
  }
}

TEST(OnSurface, DoesNotDependOnTheOrderOfFacesAndVertices) {
  Random random(2);
  const std::vector<Vec3> queries = samples_of(kHalfNodes);
  for (const TriangleMesh& mesh : meshes(random)) {
    const Diagnosed points = at_points(mesh, queries), lattice = on_lattice(mesh, kHalfNodes);
    for (int i = 0; i < 5; ++i) {
      const TriangleMesh other = test::shuffled(mesh, random);
      EXPECT_TRUE(at_points(other, queries) == points);
      EXPECT_TRUE(on_lattice(other, kHalfNodes) == lattice);
    }
  }
}

TEST(OnSurface, DoesNotDependOnTheEngineNorOnLatticeOrPoints) {
  Random random(3);
  const std::vector<Vec3> queries = samples_of(kHalfNodes);
  for (const TriangleMesh& mesh : meshes(random)) {
    const Diagnosed expected = at_points(mesh, queries);
    EXPECT_TRUE(at_points(mesh, queries, RayEngine::kEmbree) == expected);
    EXPECT_TRUE(on_lattice(mesh, kHalfNodes) == expected);
    EXPECT_TRUE(on_lattice(mesh, kHalfNodes, RayEngine::kEmbree) == expected);
  }
}

TEST(OnSurface, DoesNotDependOnThreads) {
  Random random(4);
  const std::vector<Vec3> queries = samples_of(kHalfNodes);
  for (const TriangleMesh& mesh : meshes(random)) {
    const Diagnosed expected = at_points(mesh, queries);
    for (const int threads : {1, 2, 7}) {
      const ThreadLimit limit(threads);
      EXPECT_TRUE(at_points(mesh, queries) == expected);
      EXPECT_TRUE(on_lattice(mesh, kHalfNodes) == expected);
    }
  }
}

// Formats differ in how they store a mesh: vertices once per face or shared, with or without unused ones, zeros of
// either sign.
TEST(OnSurface, DoesNotDependOnHowTheMeshWasStored) {
  Random random(5);
  const std::vector<Vec3> queries = samples_of(kHalfNodes);
  for (const TriangleMesh& mesh : meshes(random)) {
    TriangleMesh soup;
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t v : t) {
        Vec3 p = mesh.vertices[v];
        for (int axis = 0; axis < 3; ++axis) {
          if (p[axis] == 0.0 && random() % 2 == 0) p[axis] = -0.0;
        }
        soup.vertices.push_back(p);
      }
      const auto n = static_cast<std::uint32_t>(soup.vertices.size());
      soup.triangles.push_back({n - 3, n - 2, n - 1});
      soup.vertices.push_back({7, 7, 7});
    }
    EXPECT_TRUE(at_points(weld(soup, {}), queries) == at_points(mesh, queries));
  }
}

TEST(OnSurface, AStepAsideChangesTheFlag) {  // negative control: the flags are not all the same
  Random random(6);
  std::vector<Vec3> queries = samples_of(kHalfNodes);
  for (Vec3& q : queries) q = q + Vec3{0.1, 0.013, 0.0017};
  for (const TriangleMesh& mesh : meshes(random)) EXPECT_LT(at_points(mesh, queries).tally.on_surface, 20U);
}

}  // namespace
}  // namespace raycone
