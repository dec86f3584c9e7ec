// The enclosures of a cone, of three precisions: each lies within its bound of the next, and the bounds are as small as
// is promised.
#include "core/boundary/enclosure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/boundary/boundary.h"
#include "core/boundary/close_enclosure.h"
#include "core/data/rule.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Enclosures {
  TurnsWithin<long double> wide;
  TurnsWithin<Quad> close, closest;
};
Enclosures enclose(const Boundary& boundary, const Vec3& q) {
  return {enclose_in_64_bits(boundary.groups(), q), enclose_in_106_bits(boundary.groups(), q),
          enclose_in_113_bits(boundary.groups(), q)};
}

template <class A, class B>
Quad difference_of(const TurnsWithin<A>& a, const TurnsWithin<B>& b) {
  return absolute(Quad(a.whole - b.whole) + (Quad(a.rest) - Quad(b.rest)));
}

// Turns too: a turn that one precision invents is no rounding.
void expect_agreement(const Enclosures& found) {
  EXPECT_TRUE(difference_of(found.wide, found.closest) <= Quad(found.wide.bound) + found.closest.bound);
  EXPECT_TRUE(difference_of(found.close, found.closest) <= found.close.bound + found.closest.bound);
}

double bound_of(const TurnsWithin<Quad>& turns) { return static_cast<double>(turns.bound); }

// Where 64 bits are left in the dark: on planes of symmetry, at ties with vertices and edges, and at corners' heights.
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
  std::size_t close = 0, all = 0;
  for (int i = 0; i < 40; ++i) {
    TriangleMesh soup = test::soup(random, 8);
    if (i % 2 == 0) soup = snapped(soup);            // ties, edges along the rays, multiplicities
    if (i % 4 < 2) soup = test::joined(soup, soup);  // each edge twice
    const Boundary boundary(weld(soup, {}));
    for (const Vec3& q : hard_places(soup, random)) {
      const Enclosures found = enclose(boundary, q);
      expect_agreement(found);
      ++all;
      close += bound_of(found.close) < kIndistinguishable ? 1 : 0;
    }
  }
  EXPECT_EQ(close, all);
}

// A plate through the axis of the rays, nearly, as modelling programs turn them about it: every sample on it sees half
// a turn and the rounding of its corners.
TEST(Enclosures, TellPlatesThatRoundingHasTurned) {
  Random random(2);
  TriangleMesh plate;
  plate.vertices = {
      {0.085, 2.08183e-17, 0.11}, {0.085, 2.08183e-17, 0.115}, {0.09, 2.20429e-17, 0.11}, {0.09, 2.20429e-17, 0.115}};
  plate.triangles = {{0, 1, 2}, {2, 1, 3}};
  const Boundary boundary(plate);
  for (int i = 0; i < 200; ++i) {
    const double s = test::uniform(random, 0, 1), t = test::uniform(random, 0, 1);
    const Vec3 q =
        plate.vertices[0] + s * (plate.vertices[1] - plate.vertices[0]) + t * (plate.vertices[2] - plate.vertices[0]);
    const Enclosures found = enclose(boundary, q);
    expect_agreement(found);
    EXPECT_LT(bound_of(found.close), 1e-26);
  }
}

// Powers of two change no bit while numbers are in range; what leaves it is left to 113 bits, never wrong.
TEST(Enclosures, AreInfiniteOrRightAtAnyScale) {
  Random random(3);
  const TriangleMesh soup = snapped(test::soup(random, 6));
  std::size_t finite = 0;
  for (const int exponent : {-1060, -1000, -600, -300, -150, -90, 0, 90, 150, 300, 600, 1000, 1020}) {
    TriangleMesh mesh = soup;
    for (Vec3& v : mesh.vertices) v = std::exp2(exponent / 2) * (std::exp2(exponent - exponent / 2) * v);
    const Boundary boundary(weld(mesh, {}));
    for (const Vec3& q : {Vec3{0.3, 0.4, 0.5}, {0.25, 0.5, 0.75}, {-2, 0.25, 0.25}, {1e-30, 1e-30, 1e-30}, {0, 0, 0}}) {
      for (const bool along : {false, true}) {
        const Vec3 query = along ? std::exp2(exponent / 2) * (std::exp2(exponent - exponent / 2) * q) : q;
        const Enclosures found = enclose(boundary, query);
        EXPECT_LT(bound_of(found.closest), 1e-29);
        if (bound_of(found.close) < kInfinity) {
          EXPECT_TRUE(difference_of(found.close, found.closest) <= found.close.bound + found.closest.bound);
          ++finite;
        }
      }
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
  for (int i = 0; i < 10; ++i) {
    const Enclosures found = enclose(boundary, test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
    expect_agreement(found);
    EXPECT_LT(bound_of(found.close), kIndistinguishable);
    EXPECT_GT(bound_of(found.close), bound_of(found.closest));
  }
}

}  // namespace
}  // namespace raycone
