#include "core/evaluation/summation_choice.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace raycone {
namespace {

// No edges cancel, and no plane has all of them.
class OfASoup : public ::testing::Test {
 protected:
  static constexpr int kTriangles = 2000;

  [[nodiscard]] SummationChoice choice(Summation summation, const Accuracy& accuracy, bool is_in_scale = true) const {
    return {{.summation = summation, .accuracy = accuracy}, {boundary_, kTriangles, true, is_in_scale}};
  }

  test::Random random_{1};
  Boundary boundary_{test::soup(random_, kTriangles)};
};

TEST_F(OfASoup, WithoutAToleranceOnlyTheDirectSumIsOpen) {
  const SummationChoice exact = choice(Summation::kCheapest, {.tolerance = 0.0, .points = 1e9});
  EXPECT_FALSE(exact.may_have_far_field());
  EXPECT_FALSE(exact.has_blocks());
  EXPECT_FALSE(exact.blocks_of_points_may_pay());
  EXPECT_EQ(exact.doubt_of_far_field(), 0.0);
  EXPECT_EQ(exact.doubt_of_blocks(), 0.0);
}

TEST_F(OfASoup, OutOfScaleOnlyTheDirectSumIsOpen) {
  const SummationChoice large = choice(Summation::kFarField, {.tolerance = 1e-6}, false);
  EXPECT_FALSE(large.may_have_far_field());
  EXPECT_FALSE(large.has_blocks());
  EXPECT_EQ(large.doubt_of_far_field(), 0.0);
}

TEST_F(OfASoup, ToleranceIsSharedWithWhatRounds) {
  const SummationChoice rough = choice(Summation::kCheapest, {.tolerance = 1e-6});
  EXPECT_LT(rough.tolerance_of_far_field(), 1e-6);
  EXPECT_GE(rough.doubt_of_far_field(), rough.tolerance_of_far_field());
  EXPECT_EQ(choice(Summation::kCheapest, {.tolerance = 1.0}).tolerance(), 0x1p-4);
}

TEST_F(OfASoup, AFarFieldPaysWhereItIsCheaperForManySamples) {
  const SummationChoice many = choice(Summation::kCheapest, {.tolerance = 1e-6, .samples = 1e7});
  EXPECT_TRUE(many.may_have_far_field());
  EXPECT_TRUE(many.far_field_may_pay());
  EXPECT_TRUE(many.far_field_pays(many.direct_cost() / 2));
  EXPECT_FALSE(many.far_field_pays(many.direct_cost()));
  EXPECT_FALSE(choice(Summation::kCheapest, {.tolerance = 1e-6, .samples = 10}).far_field_may_pay());
}

TEST_F(OfASoup, WhatIsForcedNeedNotPay) {
  const SummationChoice far = choice(Summation::kFarField, {.tolerance = 1e-6, .samples = 1});
  EXPECT_TRUE(far.far_field_may_pay());
  EXPECT_TRUE(far.far_field_pays(1e9));
  const SummationChoice blocks = choice(Summation::kBlocks, {.tolerance = 1e-6, .points = 1});
  EXPECT_TRUE(blocks.blocks_of_points_may_pay());
  EXPECT_TRUE(blocks.blocks_of_points_pay(1e9, 1.0));
  EXPECT_FALSE(blocks.may_have_far_field());
}

TEST_F(OfASoup, BlocksOfPointsPayWherePointsAreMany) {
  const SummationChoice many = choice(Summation::kCheapest, {.tolerance = 1e-6, .points = 1e7});
  EXPECT_TRUE(many.blocks_of_points_may_pay());
  EXPECT_TRUE(many.blocks_of_points_pay(10.0, many.direct_cost()));
  EXPECT_FALSE(many.blocks_of_points_pay(many.direct_cost(), many.direct_cost()));
  EXPECT_FALSE(choice(Summation::kCheapest, {.tolerance = 1e-6}).blocks_of_points_may_pay());  // nobody knows
}

TEST(SummationChoice, NothingIsSummedForAClosedMesh) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const Boundary boundary(box);
  const SummationChoice closed({.summation = Summation::kFarField, .accuracy = {.tolerance = 1e-6, .points = 1e9}},
                               {boundary, box.triangles.size(), true, true});
  EXPECT_FALSE(closed.may_have_far_field());
  EXPECT_FALSE(closed.has_blocks());
  EXPECT_FALSE(closed.blocks_of_points_may_pay());
  EXPECT_EQ(closed.direct_cost(), 0.0);
}

}  // namespace
}  // namespace raycone
