// Whether two triangles meet beyond what they share: by hand, and against rational numbers.
#include "core/intersections/triangle_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/exact_intersections.h"

namespace raycone {
namespace {

const Corners3 kBase{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
const Corners3 kSegment{{{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}};

std::string printed(const Corners3& s, const Corners3& t) {
  std::string text;
  for (const Corners3* const triangle : {&s, &t}) {
    for (const Vec3& p : *triangle) {
      text += "(" + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + ") ";
    }
  }
  return text;
}

// All orders of corners, and either triangle first.
void expect_meeting(bool expected, Corners3 s, Corners3 t) {
  EXPECT_EQ(test::exactly_meet_beyond_shared(s, t), expected) << "the oracle: " << printed(s, t);
  const auto less = [](const Vec3& a, const Vec3& b) { return lexicographic_order(a, b) < 0; };
  std::sort(s.begin(), s.end(), less);
  do {
    std::sort(t.begin(), t.end(), less);
    do {
      EXPECT_EQ(meet_beyond_shared(s, t), expected) << printed(s, t);
      EXPECT_EQ(meet_beyond_shared(t, s), expected) << printed(t, s);
      EXPECT_EQ(MeetsBeyondShared(s)(t), expected) << printed(s, t);
      EXPECT_EQ(MeetsBeyondShared(t)(s), expected) << printed(t, s);
    } while (std::next_permutation(t.begin(), t.end(), less));
  } while (std::next_permutation(s.begin(), s.end(), less));
}

TEST(TrianglePair, ThatSharesNothingMustNotTouch) {
  expect_meeting(true, kBase, {{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}});    // through the inside
  expect_meeting(true, kBase, {{{1, 1, 0}, {1, 1, 1}, {9, 9, 1}}});     // a corner on the inside
  expect_meeting(true, kBase, {{{2, 0, 0}, {2, -1, 1}, {2, -1, -1}}});  // a corner on an edge
  expect_meeting(true, kBase, {{{0, 0, -1}, {0, 0, 1}, {-3, -3, 0}}});  // an edge through a corner
  expect_meeting(false, kBase, {{{1, 1, 1}, {2, 1, 1}, {1, 2, 2}}});
  expect_meeting(false, kBase, {{{3, 3, -1}, {3, 3, 1}, {9, 9, 1}}});
}

TEST(TrianglePair, InOnePlaneMeetsByOverlap) {
  expect_meeting(true, kBase, {{{1, 1, 0}, {9, 1, 0}, {9, 9, 0}}});
  expect_meeting(true, kBase, {{{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}});  // within
  expect_meeting(true, kBase, {{{1, 0, 0}, {3, 0, 0}, {2, -1, 0}}});     // along a part of an edge
  expect_meeting(true, kBase, {{{2, 2, 0}, {5, 2, 0}, {5, 5, 0}}});      // a corner on an edge
  expect_meeting(false, kBase, {{{3, 3, 0}, {4, 3, 0}, {4, 4, 0}}});
}

TEST(TrianglePair, MayTouchAtAnEdgeOfBoth) {
  expect_meeting(false, kBase, {{{0, 0, 0}, {4, 0, 0}, {0, 0, 4}}});
  expect_meeting(false, kBase, {{{0, 0, 0}, {4, 0, 0}, {1, -4, 0}}});  // flat on
  expect_meeting(true, kBase, {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}});    // folded over
  expect_meeting(true, kBase, {{{0, 0, 0}, {4, 0, 0}, {1, 1, 0}}});
}

TEST(TrianglePair, MayTouchAtACornerOfBoth) {
  expect_meeting(false, kBase, {{{0, 0, 0}, {1, 1, 1}, {1, 2, 1}}});
  expect_meeting(false, kBase, {{{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}});    // in one plane
  expect_meeting(false, kBase, {{{0, 0, 0}, {-1, -1, 1}, {-1, 1, -1}}});  // which the plane cuts
  expect_meeting(true, kBase, {{{0, 0, 0}, {1, 1, 1}, {1, 1, -1}}});      // through the inside
  expect_meeting(true, kBase, {{{0, 0, 0}, {9, 9, 1}, {9, 9, -1}}});
  expect_meeting(true, kBase, {{{0, 0, 0}, {1, 0, 1}, {1, 0, -1}}});  // along an edge
  expect_meeting(true, kBase, {{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}}});   // on a part of an edge
  expect_meeting(true, kBase, {{{0, 0, 0}, {8, 0, 0}, {0, -1, 0}}});
  expect_meeting(true, kBase, {{{0, 0, 0}, {9, 1, 0}, {-1, 9, 0}}});  // in one plane, around it
}

TEST(TrianglePair, OfTheSameCornersOverlaps) {
  expect_meeting(true, kBase, kBase);
  expect_meeting(false, kSegment, kSegment);  // its edges are all that there is
}

TEST(TrianglePair, WithoutAreaIsASegmentOrAPoint) {
  expect_meeting(true, kBase, {{{1, 1, -1}, {1, 1, 1}, {1, 1, 2}}});
  expect_meeting(true, kBase, {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}});
  expect_meeting(false, kBase, {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}});
  expect_meeting(false, kBase, {{{4, 0, 0}, {4, 0, 0}, {4, 0, 0}}});  // a corner of both
  expect_meeting(false, kBase, {{{4, 0, 0}, {4, 0, 0}, {5, 0, 0}}});
  expect_meeting(true, kBase, {{{4, 0, 0}, {4, 0, 0}, {1, 1, 0}}});
  expect_meeting(false, kBase, {{{0, 0, 0}, {4, 0, 0}, {0, 0, 0}}});  // an edge of both
  expect_meeting(false, kBase, kSegment);
  expect_meeting(false, kBase, {{{0, 0, 0}, {4, 0, 0}, {5, 0, 0}}});
  expect_meeting(true, kBase, {{{-1, 0, 0}, {4, 0, 0}, {5, 0, 0}}});
  expect_meeting(false, kSegment, {{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}});  // all of it on an edge of both
  expect_meeting(true, kSegment, {{{0, 0, 0}, {2, 0, 0}, {3, 0, 0}}});
  expect_meeting(false, kSegment, {{{0, 0, 0}, {2, 0, 0}, {-1, 0, 0}}});
  expect_meeting(false, kSegment, {{{0, 0, 0}, {2, 2, 0}, {4, 0, 0}}});
  expect_meeting(true, kSegment, {{{0, 0, 0}, {2, 2, 0}, {5, 0, 0}}});
}

TEST(TrianglePair, IsDecidedBeyondRounding) {
  const double step = 0x1p-52;  // the next double after 1
  const Corners3 base{{{-1, -1, 1}, {3, -1, 1}, {-1, 3, 1}}};
  expect_meeting(true, base, {{{0, 0, 1}, {0, 0, 2}, {1, 0, 2}}});
  expect_meeting(false, base, {{{0, 0, 1 + step}, {0, 0, 2}, {1, 0, 2}}});
  // A plane that no axis is along: a tenth is not the same distance from a third in all coordinates.
  const Corners3 askew{{{0.1, 0.2, 0.7}, {0.3, 0.9, 0.2}, {0.8, 0.1, 0.1}}};
  expect_meeting(false, askew, {{{0.4, 0.4, 1.0 / 3.0}, {0.4, 0.4, 1}, {0.5, 0.5, 1}}});
  // Half the sums of two corners are on the edge or one rounding beside it.
  const Vec3 middle = 0.5 * askew[0] + 0.5 * askew[1];
  const Corners3 at_middle{{middle, {0, 1, 1}, {0, 2, 1}}};
  EXPECT_EQ(meet_beyond_shared(askew, at_middle), test::exactly_meet_beyond_shared(askew, at_middle));
}

TEST(TrianglePair, OfAnyMagnitudeIsDecided) {
  for (const int exponent : {-1050, -700, 600, 1000}) {
    const auto scaled = [exponent](Corners3 t) {
      for (Vec3& p : t) p = {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
      return t;
    };
    expect_meeting(true, scaled(kBase), scaled({{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}}));
    expect_meeting(false, scaled(kBase), scaled({{{3, 3, -1}, {3, 3, 1}, {9, 9, 1}}}));
    expect_meeting(true, scaled(kBase), scaled({{{0, 0, 0}, {1, 1, 0}, {1, 1, -1}}}));
    expect_meeting(false, scaled(kBase), scaled({{{0, 0, 0}, {4, 0, 0}, {1, -4, 0}}}));
  }
}

// Corners from few places share, touch and overlap in every way.
class RandomPairs {
 public:
  RandomPairs(unsigned seed, std::vector<double> places) : random_(seed), places_(std::move(places)) {}

  void expect_oracle(int count) {
    int meeting = 0;
    for (int n = 0; n < count; ++n) {
      const Corners3 s = triangle(), t = triangle();
      const bool expected = test::exactly_meet_beyond_shared(s, t);
      meeting += expected;
      ASSERT_EQ(meet_beyond_shared(s, t), expected) << printed(s, t);
      ASSERT_EQ(meet_beyond_shared(t, s), expected) << printed(t, s);
      ASSERT_EQ(MeetsBeyondShared(s)(t), expected) << printed(s, t);
      ASSERT_EQ(MeetsBeyondShared(t)(s), expected) << printed(t, s);
    }
    EXPECT_GT(meeting, count / 50);
    EXPECT_LT(meeting, count - count / 50);
  }

 private:
  double place() { return places_[random_() % places_.size()]; }
  Vec3 point() { return {place(), place(), place()}; }
  Corners3 triangle() { return {point(), point(), point()}; }

  std::mt19937 random_;
  std::vector<double> places_;
};

TEST(TrianglePair, OnALatticeIsThatOfTheOracle) {
  RandomPairs(1, {0, 1}).expect_oracle(400);
  RandomPairs(2, {0, 1, 2}).expect_oracle(400);
  RandomPairs(3, {0, 1, 2, 3, 4}).expect_oracle(300);
}

TEST(TrianglePair, OfSliversIsThatOfTheOracle) {
  // Nearly on a lattice: what rounding would take for ties.
  RandomPairs(4, {0, 1, 1 + 0x1p-52, 1 - 0x1p-53, 0x1p-60}).expect_oracle(300);
  RandomPairs(5, {0.1, 0.2, 0.3, 0.1 + 0.2, 0.7}).expect_oracle(300);
}

TEST(TrianglePair, OfMixedMagnitudesIsThatOfTheOracle) {
  RandomPairs(6, {0, 1, -1, 1e300, -1e300, 1e-300, 5e-324}).expect_oracle(40);
}

}  // namespace
}  // namespace raycone
