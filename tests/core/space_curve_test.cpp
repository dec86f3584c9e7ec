#include "core/data/space_curve.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace raycone {
namespace {

TEST(SpaceCurve, SpreadsTwentyOneBits) {
  for (std::uint64_t bit = 0; bit < 21; ++bit)
    EXPECT_EQ(spread_bits(std::uint64_t{1} << bit), std::uint64_t{1} << 3 * bit);
  EXPECT_EQ(spread_bits(0b1011), 0b1'000'001'001U);
  EXPECT_EQ(spread_bits(std::uint64_t{1} << 21), 0U);
}

TEST(SpaceCurve, PassesCubesInOrder) {
  const SpaceCurve curve({{-1, 0, 10}, {3, 2, 12}}, 2);  // cubes of side 1
  EXPECT_EQ(curve.place({-0.5, 0.5, 10.5}), 0U);
  EXPECT_EQ(curve.place({0.5, 0.5, 10.5}), 1U);
  EXPECT_EQ(curve.place({-0.5, 1.5, 10.5}), 2U);
  EXPECT_EQ(curve.place({-0.5, 0.5, 11.5}), 4U);
  EXPECT_EQ(curve.place({2.5, 1.5, 11.5}), 0b001'111U);
}

TEST(SpaceCurve, PutsWhatIsOutsideNextToIt) {
  const SpaceCurve curve({{0, 0, 0}, {1, 1, 1}}, 7);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(curve.place({-5, -kInfinity, std::numeric_limits<double>::quiet_NaN()}), 0U);
  EXPECT_EQ(curve.place({1, 1e300, kInfinity}), (1U << 21) - 1);
  EXPECT_EQ(SpaceCurve({{2, 2, 2}, {2, 2, 2}}, 7).place({2, 2, 2}), 0U);
  EXPECT_EQ(SpaceCurve({{-1e308, 0, 0}, {1e308, 0, 0}}, 7).place({1e308, 0, 0}), 0U);  // its size is no double
}

}  // namespace
}  // namespace raycone
