// Half-integers, the critical values of rules: a value is one exactly where w is, whatever the axis, and otherwise on
// the side of it on which w is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/direct_sum.h"
#include "core/mesh/weld.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;

// The 48 symmetries of the cube as permutations of the axes and signs.
struct Symmetry {
  std::array<int, 3> axes;
  std::array<double, 3> signs;

  [[nodiscard]] Vec3 operator()(const Vec3& p) const {
    return {signs[0] * p[axes[0]], signs[1] * p[axes[1]], signs[2] * p[axes[2]]};
  }
  [[nodiscard]] bool reflects() const {
    const bool even = axes[1] == (axes[0] + 1) % 3;
    return (signs[0] * signs[1] * signs[2] < 0) == even;
  }
};

std::vector<Symmetry> symmetries() {
  std::vector<Symmetry> all;
  for (const std::array<int, 3>& axes : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
    for (int signs = 0; signs < 8; ++signs) {
      all.push_back({axes, {signs & 1 ? -1.0 : 1.0, signs & 2 ? -1.0 : 1.0, signs & 4 ? -1.0 : 1.0}});
    }
  }
  return all;
}

TriangleMesh transformed(TriangleMesh mesh, const Symmetry& symmetry) {
  for (Vec3& v : mesh.vertices) v = symmetry(v);
  return symmetry.reflects() ? test::reversed(mesh) : mesh;
}

// A cup about the z axis whose rim is a polygon of any corners at z = 0, its bottom far below.
TriangleMesh cup(Random& random, std::uint32_t corners) {
  TriangleMesh mesh;
  for (std::uint32_t n = 0; n < corners; ++n) {
    const double angle = (n + test::uniform(random, 0.1, 0.9)) * 6.28 / corners, radius = test::uniform(random, 0.6, 1);
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  mesh.vertices.push_back({0.03, 0.07, -test::uniform(random, 0.5, 2)});
  for (std::uint32_t n = 0; n < corners; ++n) mesh.triangles.push_back({n, corners, (n + 1) % corners});
  return mesh;
}

// By the crossings of a ray; none of the points asked for is level with a corner.
bool in_rim(const TriangleMesh& cup, double x, double y) {
  const std::size_t corners = cup.vertices.size() - 1;
  bool inside = false;
  for (std::size_t n = 0; n < corners; ++n) {
    const Vec3 &a = cup.vertices[n], &b = cup.vertices[(n + 1) % corners];
    if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

std::vector<double> evaluate(const TriangleMesh& mesh, const std::vector<Vec3>& queries,
                             RayEngine engine = RayEngine::kScan, Summation summation = Summation::kCheapest,
                             SimdLevel level = SimdLevel::kBest) {
  return test::values_of(WindingNumberEvaluator(mesh, {.ray_engine = engine, .level = level, .summation = summation}),
                         queries);
}

TEST(HalfIntegers, AreExactInThePlaneOfAnOpeningWhateverItsAxis) {
  Random random(1);
  for (const std::uint32_t corners : {3U, 7U, 40U}) {
    const TriangleMesh upright = cup(random, corners);
    std::vector<Vec3> nodes;
    std::vector<double> expected;
    for (int i = -12; i <= 12; ++i) {
      for (int j = -12; j <= 12; ++j) {
        nodes.push_back({i / 12.0, j / 12.0, 0});
        expected.push_back(in_rim(upright, i / 12.0, j / 12.0) ? 0.5 : 0.0);
      }
    }
    for (const Symmetry& symmetry : symmetries()) {
      const TriangleMesh mesh = transformed(upright, symmetry);
      std::vector<Vec3> queries;
      for (const Vec3& node : nodes) queries.push_back(symmetry(node));
      const std::vector<double> values = evaluate(mesh, queries);
      const std::vector<double> backwards = evaluate(test::reversed(mesh), queries);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (expected[i] == 0.5) {
          EXPECT_EQ(values[i], 0.5);
          EXPECT_EQ(backwards[i], -0.5);
        } else {
          EXPECT_NEAR(values[i], 0.0, 1e-14);  // a sum of up to 40 angles, each rounded by some 1e-16 of a turn
        }
      }
      EXPECT_EQ(evaluate(mesh, queries, RayEngine::kEmbree), values);
      EXPECT_EQ(evaluate(mesh, queries, RayEngine::kScan, Summation::kCone, SimdLevel::kSse4), values);
    }
  }
}

TEST(HalfIntegers, AreExactOnLatticesAsAtPoints) {
  Random random(2);
  const TriangleMesh upright = cup(random, 16);
  for (const Symmetry& symmetry : symmetries()) {
    const TriangleMesh mesh = transformed(upright, symmetry);
    const Lattice lattice{{0, 0, 0}, {0.125, 0.125, 0.125}, {-4, -4, -4}, {9, 9, 9}};
    const std::vector<double> values = test::values_of(WindingNumberEvaluator(mesh), lattice);
    EXPECT_EQ(evaluate(mesh, test::samples_of(lattice)), values);
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const Vec3 q = symmetry({i / 8.0, j / 8.0, 0});
        const auto place = [&](int axis) { return static_cast<std::size_t>(std::lround(q[axis] * 8) + 4); };
        const double w = values[(place(2) * 9 + place(1)) * 9 + place(0)];
        EXPECT_EQ(w == 0.5, in_rim(upright, i / 8.0, j / 8.0)) << i << ' ' << j;
      }
    }
  }
}

// Where the exterior edges do not lie in one plane, 113 bits tell that all else cancels: a cup, and beside it a sheet
// and its mirror image in the plane of the cup's opening.
TEST(HalfIntegers, AreExactWhereOtherEdgesCancel) {
  Random random(3);
  const TriangleMesh upright = cup(random, 9);
  TriangleMesh sheet;
  sheet.vertices = {{2, 0.5, 0.25}, {2.25, 1.125, 0.5}, {1.875, 2.375, 1.0625}};
  sheet.triangles = {{0, 1, 2}};
  const TriangleMesh mirrored = test::moved(sheet, {1, 1, -1}, {});  // as seen from the plane, it turns backwards
  const TriangleMesh all = test::joined(test::joined(upright, sheet), mirrored);
  for (const Symmetry& symmetry : symmetries()) {
    const TriangleMesh mesh = transformed(all, symmetry);
    std::vector<Vec3> queries;
    for (int i = -3; i <= 3; ++i) queries.push_back(symmetry({i / 10.0, 0.11 * i, 0}));
    for (const Summation summation : {Summation::kCone, Summation::kTriangles}) {
      for (const double w : evaluate(mesh, queries, RayEngine::kScan, summation)) EXPECT_EQ(w, 0.5);
    }
  }
}

// As near to the plane as doubles are, on either side.
TEST(HalfIntegers, AreNotTakenForOthers) {
  Random random(4);
  for (const std::uint32_t corners : {3U, 12U, 100U}) {
    const TriangleMesh upright = cup(random, corners);
    for (const Symmetry& symmetry : symmetries()) {
      const TriangleMesh mesh = transformed(upright, symmetry);
      std::vector<Vec3> below, above;
      for (const double distance : {5e-324, 1e-200, 1e-26, 1e-22, 1e-18, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-6}) {
        below.push_back(symmetry({0.1, 0.2, -distance}));
        above.push_back(symmetry({0.1, 0.2, distance}));
      }
      const std::vector<double> inside = evaluate(mesh, below), outside = evaluate(mesh, above);
      for (std::size_t i = 0; i < inside.size(); ++i) {
        const bool told = i >= 3;  // 1e-26 is below kIndistinguishable
        EXPECT_EQ(inside[i] > 0.5, told) << i;
        EXPECT_EQ(outside[i] < 0.5, told) << i;
        EXPECT_GE(inside[i], 0.5);
        EXPECT_LE(outside[i], 0.5);
      }
    }
  }
}

// On the rim itself w is no multiple of 1/2: the perturbed query sees the sheet under an angle.
TEST(HalfIntegers, AreNotThoseOfTheRim) {
  Random random(5);
  for (const Symmetry& symmetry : symmetries()) {
    TriangleMesh square;
    square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    const TriangleMesh mesh = transformed(square, symmetry);
    std::vector<Vec3> queries;
    for (const double x : {0.0, 0.25, 1.0}) {
      for (const double y : {0.0, 0.5, 1.0}) queries.push_back(symmetry({x, y, 0}));
    }
    const std::vector<double> values = evaluate(mesh, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      // A few roundings of the angles of four edges, of 1e-16 each.
      EXPECT_NEAR(values[i], static_cast<double>(perturbed_direct_sum(mesh, queries[i]).value), 1e-15);
    }
  }
}

// One corner of the rim is 2^-43 out of the plane of the others.
TEST(HalfIntegers, AreNotThoseOfARimThatIsNearlyFlat) {
  Random random(7);
  const TriangleMesh upright = cup(random, 12);
  for (std::size_t corner = 0; corner < 12; ++corner) {
    for (const double by : {0x1p-43, -0x1p-43}) {
      TriangleMesh bent = upright;
      bent.vertices[corner].z = by;
      for (const Symmetry& symmetry : {symmetries().front(), symmetries()[9], symmetries()[18]}) {
        const double w = evaluate(transformed(bent, symmetry), {symmetry({0.1, 0.2, 0})})[0];
        EXPECT_EQ(w > 0.5, by > 0) << corner;
        EXPECT_EQ(w < 0.5, by < 0) << corner;
      }
    }
  }
}

// The ray of the query meets an edge whose factor is beyond what pairs of doubles are trusted with: 113 bits tell.
TEST(HalfIntegers, AreToldWhereAFactorIsOutOfRange) {
  for (const double by : {0x1p-43, -0x1p-43}) {
    TriangleMesh cup;
    cup.vertices = {{0.75, 0, 0},    {0.75, 1e-305, 0}, {0.5, 0.6, 0},   {-0.7, 0.5, by},
                    {-0.6, -0.7, 0}, {0.5, -0.6, 0},    {0.03, 0.07, -1}};
    for (std::uint32_t n = 0; n < 6; ++n) cup.triangles.push_back({n, 6, (n + 1) % 6});
    const double w = evaluate(cup, {{0.125, 0, 0}})[0];
    EXPECT_EQ(w > 0.5, by > 0);
    EXPECT_EQ(w < 0.5, by < 0);
  }
}

// From the rim of a sheet that rises by 2^-43 along the rays, the perturbed query sees it under that angle: the value
// misses 1/2 by it.
TEST(HalfIntegers, AreMissedByTheAngleOfASheetAtItsRim) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0x1p-43, 0}, {1, 0x1p-43, 1}, {0, 0, 1}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (const TriangleMesh& mesh : {sheet, test::reversed(sheet)}) {
    const double w = evaluate(mesh, {{0, 0, 0.5}})[0];
    // Within two doubles, which are 2^-54 apart below 1/2. The angle makes 1.8e-14.
    EXPECT_NEAR(std::abs(w), 0.5 - 0x1p-43 / (2 * 3.14159265358979), 1e-16);
    EXPECT_NEAR(w, static_cast<double>(perturbed_direct_sum(mesh, {0, 0, 0.5}).value), 1e-16);
  }
}

// The bound that decides which values are looked at again holds, for a soup's and a sheet's edges alike.
TEST(HalfIntegers, AreLookedForWithinABoundThatHolds) {
  Random random(6);
  for (int i = 0; i < 30; ++i) {
    const TriangleMesh mesh = weld(test::soup(random, 10), {});
    for (const Summation summation : {Summation::kCone, Summation::kTriangles}) {
      const WindingNumberEvaluator evaluator(mesh, {.summation = summation});
      std::vector<Vec3> queries;
      for (int n = 0; n < 10; ++n) {
        queries.push_back(test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}}));
        const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
        const double along = test::uniform(random, 0, 1), beside = std::exp2(-test::uniform(random, 2, 20));
        queries.push_back(along * mesh.vertices[t[0]] + (1 - along) * mesh.vertices[t[1]] +
                          beside * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
      }
      const std::vector<double> values = test::values_of(evaluator, queries);
      for (std::size_t n = 0; n < queries.size(); ++n) {
        EXPECT_LE(std::abs(values[n] - static_cast<double>(perturbed_direct_sum(mesh, queries[n]).value)),
                  evaluator.doubt());
      }
      EXPECT_LT(evaluator.doubt(), 1e-10);
    }
  }
}

double settled(const WindingNumberEvaluator& evaluator, const Vec3& q, double value, double critical) {
  evaluator.settle({&q, 1}, critical, {&value, 1});
  return value;
}

TEST(HalfIntegers, AreNotLookedForInClosedMeshes) {
  const WindingNumberEvaluator evaluator(test::sphere(4));
  EXPECT_EQ(evaluator.doubt(), 0.0);
  EXPECT_EQ(settled(evaluator, {0, 0, 0}, 1.0, 1.0), 1.0);
}

// Another threshold than those: w is 1/4 on the edge that two missing sides of a box share, and 3/4 opposite of it.
TEST(HalfIntegers, AreNotTheOnlyNumbersThatCanBeSettled) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  std::erase_if(box.triangles, [&](const Triangle& t) {
    const auto all = [&](int axis) {
      return box.vertices[t[0]][axis] == 1 && box.vertices[t[1]][axis] == 1 && box.vertices[t[2]][axis] == 1;
    };
    return all(0) || all(2);
  });
  for (const Symmetry& symmetry : symmetries()) {
    const TriangleMesh mesh = transformed(box, symmetry);
    const WindingNumberEvaluator evaluator(mesh);
    for (const double y : {0.25, 0.3, 0.7}) {
      const Vec3 q = symmetry({1, y, 1});
      std::vector<double> w(1);
      evaluator.evaluate(std::vector<Vec3>{q}, w);
      EXPECT_EQ(settled(evaluator, q, w[0], 0.25), 0.25);
      const Vec3 inside = symmetry({1 - 1e-9, y, 1});
      evaluator.evaluate(std::vector<Vec3>{inside}, w);
      EXPECT_GT(settled(evaluator, inside, 0.25, 0.25), 0.25);
      EXPECT_EQ(settled(evaluator, inside, w[0], 0.25), w[0]);
    }
  }
}

// Whatever values are off by: so that rules do not depend on the tolerance.
TEST(HalfIntegers, OtherNumbersAreSettledWhereValuesAreFarOff) {
  TriangleMesh mesh = test::sphere(4);
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 20);
  const WindingNumberEvaluator evaluator(mesh);
  Random random(3);
  std::vector<Vec3> queries(500);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  for (Vec3& q : queries) q = {coordinate(random), coordinate(random), coordinate(random)};
  const std::vector<double> truth = test::values_of(evaluator, queries);
  for (const double error : {-0.1, -1e-4, 1e-4, 0.1}) {
    for (const double critical : {-0.02, 0.01, 0.3, 0.95}) {
      std::vector<double> values;
      for (const double w : truth) values.push_back(w + error);
      evaluator.settle(queries, critical, values);
      for (std::size_t n = 0; n < truth.size(); ++n) {
        ASSERT_EQ(values[n] > critical, truth[n] > critical) << truth[n] << " " << critical << " " << error;
        ASSERT_LE(std::abs(values[n] - truth[n]), std::abs(error) + evaluator.doubt());
      }
    }
  }
}

}  // namespace
}  // namespace raycone
