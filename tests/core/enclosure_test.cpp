// The enclosures of a cone, of two precisions: each lies within its bound of the other, and the bounds are as small as
// is promised.
#include "core/boundary/enclosure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/boundary/boundary.h"
#include "core/boundary/enclosure_kernel.h"
#include "core/data/rule.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Enclosures {
  std::vector<TurnsWithin> close, closest;  // in 106 and 113 bits, of each place
};
Enclosures enclose_both(const Boundary& boundary, const std::vector<Vec3>& places) {
  const DefaultFloatingPoint guard;
  Enclosures found;
  for (std::size_t begin = 0; begin < places.size(); begin += kTile) {
    SampleTile samples;
    for (std::size_t n = begin; n < std::min(begin + kTile, places.size()); ++n) samples.add(places[n]);
    found.close.resize(begin + samples.count);
    enclose_in_106_bits(boundary.groups(), samples, std::span(found.close).subspan(begin));
  }
  for (const Vec3& q : places) found.closest.push_back(enclose_in_113_bits(boundary.groups(), q));
  return found;
}

Quad difference_of(const TurnsWithin& a, const TurnsWithin& b) {
  return absolute(static_cast<Quad>(a.whole - b.whole) + (a.rest - b.rest));
}

double bound_of(const TurnsWithin& turns) { return static_cast<double>(turns.bound); }

// Turns too: a turn that one precision invents is no rounding. Returns the largest bound in 106 bits.
double expect_agreement(const Enclosures& found) {
  double largest = 0.0;
  for (std::size_t n = 0; n < found.close.size(); ++n) {
    const TurnsWithin &close = found.close[n], &closest = found.closest[n];
    EXPECT_TRUE(difference_of(close, closest) <= close.bound + closest.bound) << n;
    largest = std::max(largest, bound_of(close));
  }
  return largest;
}

// On planes of symmetry, at ties with vertices and edges, and at corners' heights.
std::vector<Vec3> hard_places(const TriangleMesh& mesh, Random& random) {
  std::vector<Vec3> places;
  const auto vertex = [&] { return mesh.vertices[random() % mesh.vertices.size()]; };
  for (int n = 0; n < 20; ++n) {
    const Vec3 a = vertex(), b = vertex(), c = vertex();
    places.push_back(a);                                                // at a vertex
    places.push_back({a.x - test::uniform(random, -1, 1), a.y, a.z});   // the ray through it
    places.push_back(0.5 * (a + b));                                    // on an edge, perhaps
    places.push_back({test::uniform(random, -1, 1), a.y, b.z});         // level with edges
    places.push_back(0.25 * a + 0.25 * b + 0.5 * c);                    // in planes
    const double beside = std::exp2(test::uniform(random, -1000, -1));  // next to an edge
    places.push_back(0.5 * (a + b) + beside * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
    places.push_back(test::uniform_point(random, {{-2, -2, -2}, {2, 2, 2}}));
  }
  return places;
}

TriangleMesh snapped(TriangleMesh mesh) {
  for (Vec3& v : mesh.vertices) v = {std::round(4 * v.x) / 4, std::round(4 * v.y) / 4, std::round(4 * v.z) / 4};
  return mesh;
}

TEST(Enclosures, LieWithinTheirBoundsOfEachOther) {
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    TriangleMesh soup = test::soup(random, 8);
    if (i % 2 == 0) soup = snapped(soup);            // ties, edges along the rays, multiplicities
    if (i % 4 < 2) soup = test::joined(soup, soup);  // each edge twice
    const Boundary boundary(weld(soup, {}));
    EXPECT_LT(expect_agreement(enclose_both(boundary, hard_places(soup, random))), kIndistinguishable);
  }
}

// A plate through the axis of the rays, nearly, as modelling programs turn them about it: every sample on it sees half
// a turn and the rounding of its corners.
TEST(Enclosures, TellPlatesThatRoundingHasTurned) {
  Random random(2);
  TriangleMesh plate;
  plate.vertices = {
      {0.085, 2.08183e-17, 0.11}, {0.085, 2.08183e-17, 0.115}, {0.09, 2.20429e-17, 0.11}, {0.09, 2.20429e-17, 0.115}};
  plate.triangles = {{0, 1, 2}, {2, 1, 3}};
  std::vector<Vec3> places;
  for (int i = 0; i < 200; ++i) {
    const double s = test::uniform(random, 0, 1), t = test::uniform(random, 0, 1);
    places.push_back(plate.vertices[0] + s * (plate.vertices[1] - plate.vertices[0]) +
                     t * (plate.vertices[2] - plate.vertices[0]));
  }
  EXPECT_LT(expect_agreement(enclose_both(Boundary(plate), places)), 1e-26);
}

// What leaves the range of doubles has no bound, or a right one.
TEST(Enclosures, AreInfiniteOrRightAtAnyScale) {
  Random random(3);
  const TriangleMesh soup = snapped(test::soup(random, 6));
  std::size_t finite = 0;
  for (const int exponent : {-1060, -1000, -600, -300, -150, -90, 0, 90, 150, 300, 600, 1000, 1020}) {
    const auto scaled = [&](const Vec3& v) {
      return std::exp2(exponent / 2) * (std::exp2(exponent - exponent / 2) * v);
    };
    TriangleMesh mesh = soup;
    for (Vec3& v : mesh.vertices) v = scaled(v);
    std::vector<Vec3> places;
    for (const Vec3& q : {Vec3{0.3, 0.4, 0.5}, {0.25, 0.5, 0.75}, {-2, 0.25, 0.25}, {1e-30, 1e-30, 1e-30}, {0, 0, 0}}) {
      places.insert(places.end(), {q, scaled(q)});
    }
    const Boundary boundary(weld(mesh, {}));
    for (const Vec3& q : places) {
      const Enclosures found = enclose_both(boundary, {q});
      EXPECT_LT(bound_of(found.closest[0]), 1e-29);
      if (!(bound_of(found.close[0]) < kInfinity)) continue;
      expect_agreement(found);
      ++finite;
    }
  }
  EXPECT_GT(finite, 60U);  // of 130
}

// Many edges: errors add up, and so do the bounds, to less than what counts as equal.
TEST(Enclosures, OfManyEdgesAreCloseStill) {
  Random random(4);
  TriangleMesh cup = test::sphere(64);
  std::erase_if(cup.triangles, [&](const Triangle&) { return random() % 4 == 0; });
  const Boundary boundary(weld(cup, {}));
  ASSERT_GT(boundary.exterior_edges(), 5000U);
  std::vector<Vec3> places;
  for (int i = 0; i < 10; ++i) places.push_back(test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
  EXPECT_LT(expect_agreement(enclose_both(boundary, places)), kIndistinguishable);
}

// As large as the analysis says: 40 e for each factor, whose condition is 1 or more, and 4 e for each product. True
// errors are a thousandth of that, so that no comparison with them would notice less.
TEST(Enclosures, HaveBoundsOfAllRoundings) {
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    const Boundary boundary(weld(test::soup(random, 8), {}));
    std::vector<Vec3> places;
    for (int n = 0; n < 20; ++n) places.push_back(test::uniform_point(random, {{-1, -1, -1}, {2, 2, 2}}));
    const Enclosures found = enclose_both(boundary, places);
    const double least = 44 * 0x1p-100 * boundary.total_multiplicity() / (2 * std::numbers::pi);
    for (const TurnsWithin& close : found.close) {
      EXPECT_GE(bound_of(close), least * (1 - 1e-9));
      EXPECT_LE(bound_of(close), least * 64);  // conditions are below that
    }
  }
}

// An edge that a ray does not meet adds nothing, and 0 is 0, whatever stands for it meanwhile.
TEST(Enclosures, OfNothingAreZero) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  const Enclosures found = enclose_both(Boundary(flat), {{5, 0.25, 0}, {-5, 0.25, 0}, {0.5, 7, 0}});
  for (const TurnsWithin& close : found.close) {
    const Quad distance = close.rest < 0 ? -close.rest : close.rest;
    EXPECT_TRUE(distance == 0 || distance == Quad(0.5)) << static_cast<double>(close.rest);
  }
  TriangleMesh copies = flat;
  copies.triangles.assign(33, {0, 1, 2});  // so many that values come from here
  std::vector<double> w(3);
  WindingNumberEvaluator(copies).evaluate(std::vector<Vec3>{{5, 0.25, 0}, {-5, 0.25, 0}, {0.5, 7, 0}}, w);
  for (const double value : w) EXPECT_EQ(value, 0.0);
}

// Of all levels, and of a sample whatever else is in its tile.
TEST(Enclosures, HaveTheSameBitsInAnyLanes) {
  const DefaultFloatingPoint guard;
  Random random(5);
  for (int i = 0; i < 10; ++i) {
    const TriangleMesh soup = i % 2 == 0 ? snapped(test::soup(random, 8)) : test::soup(random, 8);
    const Boundary boundary(weld(soup, {}));
    const std::vector<Vec3> places = hard_places(soup, random);
    for (const ChainGroup& group : boundary.groups()) {
      for (std::size_t n = 0; n < places.size(); ++n) {
        SampleTile alone, among;
        alone.add(places[n]);
        const std::size_t at = n % kTile;
        for (std::size_t k = n - at; k <= n; ++k) among.add(places[k]);
        alone.fill_up();
        among.fill_up();
        PairProductTile expected, found;
        enclosure_kernel(SimdLevel::kBest)(group.steps, alone, expected);
        for (const SimdLevel level : {SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
          if (!is_available(level)) continue;
          enclosure_kernel(level)(group.steps, among, found);
          EXPECT_EQ(found.re_high[at], expected.re_high[0]);
          EXPECT_EQ(found.re_low[at], expected.re_low[0]);
          EXPECT_EQ(found.im_high[at], expected.im_high[0]);
          EXPECT_EQ(found.im_low[at], expected.im_low[0]);
          EXPECT_EQ(found.turns[at], expected.turns[0]);
          EXPECT_EQ(found.error[at], expected.error[0]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace raycone
