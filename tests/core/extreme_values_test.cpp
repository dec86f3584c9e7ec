// Values of meshes whose coordinates span the whole range of double, against direct sums that no magnitude troubles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/data/lattice_slabs.h"
#include "core/evaluation/winding_number.h"
#include "core/exact/direct_sum.h"
#include "core/mesh/weld.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;

constexpr Summation kBoth[] = {Summation::kCone, Summation::kTriangles};
constexpr RayEngine kBothEngines[] = {RayEngine::kScan, RayEngine::kEmbree};

// Of all exponents alike: 0, subnormal numbers and the largest ones among them.
double of_any_magnitude(Random& random) {
  if (random() % 8 == 0) return 0.0;
  const double digits = random() % 2 == 0 ? 1.0 : test::uniform(random, 0.5, 1);
  const double magnitude = std::ldexp(digits, static_cast<int>(random() % 2098) - 1074);
  return random() % 2 == 0 ? magnitude : -magnitude;
}

TriangleMesh mesh_of_any_magnitudes(Random& random, int triangles) {
  TriangleMesh mesh = test::soup(random, triangles);
  for (Vec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) v[axis] = of_any_magnitude(random);
  }
  return weld(mesh, {});
}

// Coordinates of vertices, one unit in the last place beside them, between two of them, or anything.
std::vector<Vec3> queries_about(const TriangleMesh& mesh, Random& random, int count) {
  const auto vertex = [&] { return mesh.vertices[mesh.triangles[random() % mesh.triangles.size()][random() % 3]]; };
  std::vector<Vec3> queries;
  for (int i = 0; i < count; ++i) {
    Vec3 q = vertex();
    for (int axis = 0; axis < 3; ++axis) {
      const double x = random() % 2 == 0 ? q[axis] : vertex()[axis];
      const std::array<double, 6> choices{x,
                                          x,
                                          std::nextafter(x, HUGE_VAL),
                                          std::nextafter(x, -HUGE_VAL),
                                          x / 2 + vertex()[axis] / 2,
                                          of_any_magnitude(random)};
      q[axis] = choices[random() % choices.size()];
      if (!std::isfinite(q[axis])) q[axis] = x;
    }
    queries.push_back(q);
  }
  return queries;
}

double largest_error(const TriangleMesh& mesh, const std::vector<Vec3>& queries, RayEngine engine,
                     Summation summation) {
  const std::vector<double> values =
      test::values_of(WindingNumberEvaluator(mesh, {.ray_engine = engine, .summation = summation}), queries);
  Quad largest = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const QuadWithin exact = perturbed_direct_sum(mesh, queries[i]);
    EXPECT_LT(exact.error, 1e-18);
    const Quad difference = values[i] - exact.value;
    const Quad error = difference < 0 ? -difference : difference;
    EXPECT_LT(error, 1e-12) << queries[i].x << ' ' << queries[i].y << ' ' << queries[i].z << ": " << values[i]
                            << " in place of " << static_cast<double>(exact.value);
    largest = std::max(largest, error);
  }
  return static_cast<double>(largest);
}

// The error near an edge may reach 2e-13 (docs/method.md); of a dozen edges, 1e-12 is enough.
TEST(ExtremeValues, AreRightForCoordinatesOfAllMagnitudes) {
  Random random(1);
  for (int i = 0; i < 24; ++i) {
    const TriangleMesh mesh = mesh_of_any_magnitudes(random, 1 + i % 4);
    const std::vector<Vec3> queries = queries_about(mesh, random, 12);
    for (const Summation summation : kBoth) largest_error(mesh, queries, kBothEngines[i % 2], summation);
  }
}

// Of triangles near 1, so that they are in scale, and queries at any distance.
TEST(ExtremeValues, FarFieldsKeepTheirTolerance) {
  constexpr double kTolerance = 1e-6;
  Random random(3);
  for (const int triangles : {1, 2, 40, 400}) {
    const TriangleMesh mesh = weld(test::soup(random, triangles), {});
    std::vector<Vec3> queries = queries_about(mesh, random, 60);
    for (const double far : {1e100, 1e160, 1e200, 1e308}) queries.push_back({far, 0.5, 0.5});
    for (const Summation summation : {Summation::kFarField, Summation::kBlocks}) {
      const std::vector<double> values = test::values_of(
          WindingNumberEvaluator(mesh, {.summation = summation, .accuracy = {kTolerance, 1e6}}), queries);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto exact = static_cast<double>(perturbed_direct_sum(mesh, queries[i]).value);
        EXPECT_NEAR(values[i], exact, kTolerance) << queries[i].x << ' ' << queries[i].y << ' ' << queries[i].z;
      }
    }
  }
}

// Magnitudes that two numbers share, as those of a small part beside a huge one do.
TEST(ExtremeValues, AreRightForTrianglesWithOneMinuteSide) {
  Random random(2);
  for (const int small : {-1070, -900, -520, -300, -40}) {
    for (const int large : {-20, 200, 400, 500, 900, 1020}) {
      const double near = std::ldexp(1.0, small), far = std::ldexp(1.0, large);
      for (int i = 0; i < 4; ++i) {
        TriangleMesh mesh = test::soup(random, 2);
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
          mesh.vertices[v] = (v % 3 == 0 ? near : far) * (2 * mesh.vertices[v] - Vec3{1, 1, 1});
        }
        std::vector<Vec3> queries;
        for (int n = 0; n < 4; ++n) queries.push_back(near * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
        for (const Summation summation : kBoth) largest_error(mesh, queries, RayEngine::kScan, summation);
      }
    }
  }
}

// Faces on top of one another, as in meshes that were joined with themselves: an argument is multiplied by their
// number.
TEST(ExtremeValues, OfManyCopiesAreAsRightAsExpected) {
  Random random(4);
  for (const std::size_t copies : {32U, 33U, 256U, 1000U, 100'000U}) {
    const TriangleMesh few = test::soup(random, 3);
    TriangleMesh many = few;
    many.triangles.clear();
    for (std::size_t n = 0; n < copies; ++n) many.triangles.push_back(few.triangles[0]);
    for (std::size_t n = 0; n < copies / 2; ++n) many.triangles.push_back(few.triangles[1]);
    many.triangles.push_back(few.triangles[2]);
    std::vector<Vec3> queries = queries_about(few, random, 20);
    std::erase_if(queries, [](const Vec3& q) { return !(std::abs(q.x) + std::abs(q.y) + std::abs(q.z) < 10); });
    for (int n = 0; n < 2000; ++n) {  // beside an edge, where factors cancel most before the careful ones take over
      const double along = test::uniform(random, 0, 1), beside = std::exp2(-test::uniform(random, 3, 12));
      queries.push_back(along * few.vertices[0] + (1 - along) * few.vertices[1] +
                        beside * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
    }
    const WindingNumberEvaluator evaluator(many, {.accuracy = {.tolerance = 0.0}});
    const std::vector<double> values = test::values_of(evaluator, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      Quad exact = 0;
      const std::size_t counts[] = {copies, copies / 2, 1};
      for (std::size_t t = 0; t < 3; ++t) {
        exact +=
            static_cast<Quad>(counts[t]) * perturbed_direct_sum({few.vertices, {few.triangles[t]}}, queries[i]).value;
      }
      const auto error = static_cast<double>(values[i] - exact);
      EXPECT_LE(std::abs(error), evaluator.expected_error()) << copies << ": " << values[i];
    }
  }
}

// Needles with one long edge in common: beside it, the roundings of all their edges have one sign.
TEST(ExtremeValues, OfNeedlesWhoseRoundingsAgreeAreOffByMoreThanExpected) {
  Random random(5);
  const Vec3 a{0.3712345, -0.9134567, -0.8765432}, b{-0.4123457, 0.8345671, 0.9456783};
  TriangleMesh needles{{a, b}, {}};
  for (std::uint32_t n = 2; n < 1002; ++n) {
    needles.vertices.push_back(b + 1e-5 * test::uniform_point(random, {{0, 0, 0}, {1, 1, 1}}));
    needles.triangles.push_back({0, 1, n});
  }
  std::vector<Vec3> queries;
  for (int n = 0; n < 200; ++n) {
    const double along = test::uniform(random, 0, 1), beside = std::exp2(-test::uniform(random, 3, 11));
    queries.push_back(along * a + (1 - along) * b + beside * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
  }
  const WindingNumberEvaluator evaluator(needles, {.accuracy = {.tolerance = 0.0}});
  const std::vector<double> values = test::values_of(evaluator, queries);
  double largest = 0.0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto error = static_cast<double>(values[i] - perturbed_direct_sum(needles, queries[i]).value);
    largest = std::max(largest, std::abs(error));
  }
  EXPECT_GT(largest, evaluator.expected_error()) << "else there is nothing to be said";
  EXPECT_LE(largest, evaluator.error_of_agreeing_roundings());
}

// --- Byte equality ---

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> result;
  for (const double value : values) result.push_back(std::bit_cast<std::uint64_t>(value));
  return result;
}

std::vector<double> in_slabs(const WindingNumberEvaluator& evaluator, const Lattice& lattice, int axis,
                             std::int64_t thickness) {
  const auto a = static_cast<std::size_t>(axis);
  std::vector<double> values(static_cast<std::size_t>(whole(lattice).size()));
  for (std::int64_t begin = 0; begin < lattice.counts[a]; begin += thickness) {
    const LatticeBlock slab = slab_of(whole(lattice), a, begin, thickness);
    std::vector<double> part(static_cast<std::size_t>(slab.size()));
    evaluator.evaluate(lattice, slab, part);
    const double* value = part.data();
    for_each_sample(slab, [&](const LatticeIndex& index) { values[whole(lattice).number_of(index)] = *value++; });
  }
  return values;
}

// The scale stays as it is, as it would drop bits of one coordinate; differences of others are beyond the doubles.
TEST(ExtremeValues, OfLatticesAreThoseOfPointsWhereDifferencesOverflow) {
  Random random(5);
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr std::int64_t kHalf = 6;
  const auto steps = [](double length) { return length / kHalf * Vec3{1, 1, 1}; };
  int inside = 0;
  for (int i = 0; i < 160; ++i) {
    TriangleMesh mesh{{}, {{0, 1, 2}}};
    for (int corner = 0; corner < 3; ++corner) {
      const auto huge = [&] { return kLargest * test::uniform(random, -1, 1); };
      mesh.vertices.push_back({0.1, huge(), huge()});
    }
    Lattice lattice{{-1, 0, 0}, steps(0.95 * kLargest), {0, -kHalf, -kHalf}, {1, 2 * kHalf + 1, 2 * kHalf + 1}};
    lattice.spacing[1 + i % 2] *= 0.07;  // sections are for boxes of many rows
    const WindingNumberEvaluator evaluator(mesh);
    const std::vector<double> at_points = test::values_of(evaluator, test::samples_of(lattice)),
                              on_lattice = test::values_of(evaluator, lattice);
    EXPECT_EQ(bits(on_lattice), bits(at_points)) << i;
    inside += std::ranges::count_if(at_points, [](double w) { return w < -0.25; }) > 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 8) << "few rays met a triangle: nothing was tested";
}

// One coordinate of the lattice is so small that scaling the mesh to 1 would drop its bits: whether a sample is
// evaluated in scale must be a matter of that sample.
TEST(ExtremeValues, DoNotDependOnSlabsThatHoldMinuteCoordinates) {
  Random random(3);
  for (const double size : {0x1p20, 0x1p100}) {
    for (const Summation summation : kBoth) {
      TriangleMesh mesh = test::soup(random, 12);
      for (Vec3& v : mesh.vertices) v = size * (v - Vec3{0.5, 0.5, 0.5});
      const WindingNumberEvaluator evaluator(mesh, {.summation = summation});
      const double tiny = 5 * std::numeric_limits<double>::denorm_min();
      for (int axis = 0; axis < 3; ++axis) {
        Lattice lattice{{0.01 * size, 0.02 * size, 0.03 * size}, 0.07 * size * Vec3{1, 1, 1}, {-2, -3, -2}, {5, 6, 4}};
        lattice.origin[axis] = tiny;  // index 0 is at 5 * 2^-1074
        const std::vector<double> expected = in_slabs(evaluator, lattice, 2, 4);
        for (int cut = 0; cut < 3; ++cut) {
          EXPECT_EQ(bits(in_slabs(evaluator, lattice, cut, 1)), bits(expected))
              << size << " axis " << axis << ' ' << cut;
        }
        const std::vector<Vec3> points = test::samples_of(lattice);
        const std::vector<double> at_points = test::values_of(evaluator, points);
        EXPECT_EQ(bits(at_points), bits(expected)) << size << " axis " << axis;
      }
    }
  }
}

}  // namespace
}  // namespace raycone
