#include "core/boundary/solid_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "tests/support/differences.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::largest_difference;

constexpr Summation kBothSums[] = {Summation::kCone, Summation::kTriangles};

std::vector<double> evaluate(const TriangleMesh& mesh, const Lattice& lattice, Summation summation,
                             SimdLevel level = SimdLevel::kBest) {
  return test::values_of(WindingNumberEvaluator(mesh, {.level = level, .summation = summation}), lattice);
}

// Rows through corners, edges and along faces of meshes with corners on integers.
Lattice half_integers(std::int64_t from, std::int64_t count) {
  Lattice lattice;
  lattice.spacing = {0.5, 0.5, 0.5};
  lattice.index_min = {from, from, from};
  lattice.counts = {count, count, count};
  return lattice;
}

// Each triangle contributes some 50 u / 2^-6 / 2 pi at worst, where the query is just not next to it; 60 of them.
constexpr double kTolerance = 1e-12;

TEST(SolidAngles, SumUpToWhatCrossingsAndConeGive) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const TriangleMesh mesh = test::lattice_soup(random, 60, 4);
    const Lattice lattice = half_integers(-2, 13);
    EXPECT_LT(largest_difference(evaluate(mesh, lattice, kBothSums[0]), evaluate(mesh, lattice, kBothSums[1])),
              kTolerance);
  }
}

TEST(SolidAngles, JumpOnTheSurfaceAsCrossingsDo) {
  // The unit cube without its top: its lower faces hold the sample, its upper ones do not.
  const Lattice lattice = half_integers(0, 3);
  const std::vector<double> w = evaluate(test::open_box(), lattice, Summation::kTriangles);
  EXPECT_LT(largest_difference(w, evaluate(test::open_box(), lattice, Summation::kCone)), kTolerance);
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) { return w[i + 3 * (j + 3 * k)]; };
  EXPECT_GT(at(0, 1, 1), 0.5);
  EXPECT_NEAR(at(0, 1, 1) - at(2, 1, 1), 1.0, kTolerance);
}

TEST(SolidAngles, AreTheSameAtEverySimdLevelAndForPoints) {
  test::Random random(2);
  const TriangleMesh mesh = weld(test::soup(random, 100), {});
  const Lattice lattice = half_integers(-3, 9);
  const std::vector<double> expected = evaluate(mesh, lattice, Summation::kTriangles);
  for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (!is_available(level)) continue;
    EXPECT_EQ(evaluate(mesh, lattice, Summation::kTriangles, level), expected);
  }
  const std::vector<Vec3> points = test::samples_of(lattice);
  const std::vector<double> values =
      test::values_of(WindingNumberEvaluator(mesh, {.summation = Summation::kTriangles}), points);
  EXPECT_EQ(values, expected);
}

TEST(SolidAngles, AreTakenForSoupsOnly) {
  test::Random random(3);
  const TriangleMesh soup = test::soup(random, 50), box = test::open_box();
  EXPECT_TRUE(SolidAngles::are_cheaper(soup.triangles.size(), exterior_edges(soup).size()));
  EXPECT_FALSE(SolidAngles::are_cheaper(box.triangles.size(), exterior_edges(box).size()));
  const Lattice lattice = half_integers(-1, 5);
  EXPECT_EQ(evaluate(soup, lattice, Summation::kCheapest), evaluate(soup, lattice, Summation::kTriangles));
  EXPECT_EQ(evaluate(box, lattice, Summation::kCheapest), evaluate(box, lattice, Summation::kCone));
  // Or nothing could tell the two apart.
  EXPECT_NE(evaluate(soup, lattice, Summation::kCone), evaluate(soup, lattice, Summation::kTriangles));
}

// The factors of far, near, tiny and needle-like triangles, whose products may leave the range of doubles.
TEST(SolidAngles, OfTrianglesOfAllSizes) {
  test::Random random(4);
  for (int exponent = -300; exponent <= 300; exponent += 60) {
    TriangleMesh mesh = test::soup(random, 40);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 3) {
      const double size = std::ldexp(1.0, -static_cast<int>(i % 60));
      mesh.vertices[i + 1] = mesh.vertices[i] + size * (mesh.vertices[i + 1] - mesh.vertices[i]);
      mesh.vertices[i + 2] = mesh.vertices[i] + size * (mesh.vertices[i + 2] - mesh.vertices[i]);
    }
    const double scale = std::ldexp(1.0, exponent);
    for (Vec3& v : mesh.vertices) v = scale * v;
    mesh = weld(mesh, {});
    Lattice lattice = half_integers(-30, 60);
    lattice.spacing = scale * Vec3{0.1, 0.1, 0.1};
    EXPECT_LT(largest_difference(evaluate(mesh, lattice, kBothSums[0]), evaluate(mesh, lattice, kBothSums[1])),
              kTolerance);
  }
}

}  // namespace
}  // namespace raycone
