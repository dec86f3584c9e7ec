// The lattice rules of the command line, on boxes of every kind.
#include "app/samples/lattice_choice.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "app/process/usage_error.h"
#include "io/files/file_error.h"
#include "tests/support/error_text.h"

namespace raycone::test {
namespace {

using Counts = std::array<std::int64_t, 3>;

struct Choice {
  Lattice lattice;
  std::vector<Warning> warnings;
};

Choice choose(const Box& box, const LatticeRequest& request) {
  Choice choice;
  choice.lattice = choose_lattice(box, request, choice.warnings);
  return choice;
}

LatticeRequest sampled(std::variant<LongestSide, SampleCounts, VoxelSize> sampling, bool centers = false) {
  LatticeRequest request;
  request.sampling = sampling;
  request.centers = centers;
  return request;
}

const Box kUnit{{0, 0, 0}, {1, 1, 1}};
const Box kBrick{{-1, 0, 5}, {3, 2, 6}};  // sides 4, 2, 1
const Box kSheet{{0, 0, 7}, {4, 2, 7}};   // flat along z
const Box kNeedle{{0, 3, 7}, {4, 3, 7}};  // flat along y and z
const Box kPoint{{1, 2, 3}, {1, 2, 3}};

TEST(LatticeChoice, DefaultIs64SamplesAlongTheLongestSide) {
  const Lattice lattice = choose(kBrick, {}).lattice;
  EXPECT_EQ(lattice.counts, (Counts{64, 33, 17}));
  EXPECT_EQ(lattice.origin, kBrick.lower);
  EXPECT_EQ(lattice.spacing, (Vec3{4.0 / 63, 4.0 / 63, 4.0 / 63}));
  EXPECT_EQ(lattice.index_min, (Counts{0, 0, 0}));
}

TEST(LatticeChoice, SidesThatAreMultiplesOfTheSpacingEndAtASample) {
  EXPECT_EQ(choose(kBrick, sampled(LongestSide{5})).lattice.counts, (Counts{5, 3, 2}));
  // 0.3 / 0.1 is above 3 in double; the slack of 1e-9 keeps it from adding a sample.
  const Box tenths{{0, 0, 0}, {0.6, 0.3, 0.30000000000000004}};
  EXPECT_EQ(choose(tenths, sampled(LongestSide{7})).lattice.counts, (Counts{7, 4, 4}));
}

TEST(LatticeChoice, SidesBeyondTheSlackGetOneMoreSample) {
  const Box brick{{0, 0, 0}, {4, 2 + 1e-8, 2 - 1e-8}};
  EXPECT_EQ(choose(brick, sampled(LongestSide{5})).lattice.counts, (Counts{5, 4, 3}));
}

TEST(LatticeChoice, OneSampleAlongTheLongestSideIsTheMiddle) {
  const Lattice lattice = choose(kBrick, sampled(LongestSide{1})).lattice;
  EXPECT_EQ(lattice.counts, (Counts{1, 1, 1}));
  EXPECT_EQ(lattice.origin, (Vec3{1, 1, 5.5}));
  EXPECT_EQ(lattice.spacing, (Vec3{4, 4, 4}));
}

TEST(LatticeChoice, FlatBoxGetsOneLayerWithoutWarning) {
  const Choice choice = choose(kSheet, sampled(LongestSide{5}));
  EXPECT_EQ(choice.lattice.counts, (Counts{5, 3, 1}));
  EXPECT_EQ(choice.lattice.coordinate(2, 0), 7.0);
  EXPECT_EQ(choice.lattice.spacing.z, 1.0);
  EXPECT_TRUE(choice.warnings.empty());
}

TEST(LatticeChoice, PointGetsOneSample) {
  for (const auto& request :
       {sampled(LongestSide{9}), sampled(SampleCounts{{1, 1, 1}}), sampled(LongestSide{9}, true)}) {
    const Choice choice = choose(kPoint, request);
    EXPECT_EQ(choice.lattice.counts, (Counts{1, 1, 1}));
    EXPECT_EQ(choice.lattice.origin, kPoint.lower);
    EXPECT_EQ(choice.lattice.spacing, (Vec3{1, 1, 1}));
    EXPECT_TRUE(choice.warnings.empty());
  }
}

TEST(LatticeChoice, CountsIncludeBothEnds) {
  const Lattice lattice = choose(kBrick, sampled(SampleCounts{{5, 2, 3}})).lattice;
  EXPECT_EQ(lattice.counts, (Counts{5, 2, 3}));
  EXPECT_EQ(lattice.origin, kBrick.lower);
  EXPECT_EQ(lattice.spacing, (Vec3{1, 2, 0.5}));
  EXPECT_EQ(lattice.coordinate(2, lattice.index_max(2)), 6.0);
}

TEST(LatticeChoice, CountOfOneSamplesTheMiddle) {
  const Lattice lattice = choose(kBrick, sampled(SampleCounts{{5, 1, 1}})).lattice;
  EXPECT_EQ(lattice.origin, (Vec3{-1, 1, 5.5}));
  EXPECT_EQ(lattice.spacing, (Vec3{1, 2, 1})) << "the side's length where one sample stands for it";
}

TEST(LatticeChoice, FlatSideGetsOneSampleAndTheSpacingOfTheSmallestOtherSide) {
  const Choice choice = choose(kSheet, sampled(SampleCounts{{5, 5, 50}}));
  EXPECT_EQ(choice.lattice.counts, (Counts{5, 5, 1}));
  EXPECT_EQ(choice.lattice.spacing, (Vec3{1, 0.5, 0.5}));
  EXPECT_EQ(choice.lattice.origin, kSheet.lower);
  EXPECT_EQ(choice.warnings,
            (std::vector<Warning>{{"flat-box", "the box is flat along z, and sampled once there, not 50 times"}}));
}

TEST(LatticeChoice, FlatSidesAreWarnedAboutUnlessOneSampleWasAsked) {
  EXPECT_EQ(
      choose(kNeedle, sampled(SampleCounts{{5, 6, 7}})).warnings,
      (std::vector<Warning>{{"flat-box", "the box is flat along y and z, and sampled once there, not 6 and 7 times"}}));
  EXPECT_EQ(choose(kNeedle, sampled(SampleCounts{{5, 1, 1}})).warnings.size(), 0U);
  EXPECT_EQ(choose(kNeedle, sampled(SampleCounts{{5, 1, 1}})).lattice.spacing, (Vec3{1, 1, 1}));
}

TEST(LatticeChoice, VoxelsAreAlignedWithTheWorldsOrigin) {
  const Box box{{-1.1, 0.5, 0.75}, {1.1, 1.0, 2.0}};
  const Lattice lattice = choose(box, sampled(VoxelSize{{0.5, 0.5, 0.5}})).lattice;
  EXPECT_EQ(lattice.origin, (Vec3{0, 0, 0}));
  EXPECT_EQ(lattice.spacing, (Vec3{0.5, 0.5, 0.5}));
  EXPECT_EQ(lattice.index_min, (Counts{-3, 1, 1}));
  EXPECT_EQ(lattice.counts, (Counts{7, 2, 4}));
}

TEST(LatticeChoice, VoxelsMayBeAnisotropic) {
  const Lattice lattice = choose(kUnit, sampled(VoxelSize{{0.5, 0.25, 2}})).lattice;
  EXPECT_EQ(lattice.counts, (Counts{3, 5, 2}));
}

TEST(LatticeChoice, CentersOfCellsAlongTheLongestSide) {
  const Lattice lattice = choose(kBrick, sampled(LongestSide{4}, true)).lattice;
  EXPECT_EQ(lattice.counts, (Counts{4, 2, 1}));
  EXPECT_EQ(lattice.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(lattice.origin, (Vec3{-0.5, 0.5, 5.5}));
}

TEST(LatticeChoice, CentersOfCellsByCount) {
  const Lattice lattice = choose(kBrick, sampled(SampleCounts{{4, 1, 2}}, true)).lattice;
  EXPECT_EQ(lattice.counts, (Counts{4, 1, 2}));
  EXPECT_EQ(lattice.spacing, (Vec3{1, 2, 0.5}));
  EXPECT_EQ(lattice.origin, (Vec3{-0.5, 1, 5.25}));
}

TEST(LatticeChoice, CentersOfAlignedVoxels) {
  const Box box{{-1.1, 0.5, 2}, {1.1, 1.0, 2}};
  const Lattice lattice = choose(box, sampled(VoxelSize{{0.5, 0.5, 0.5}}, true)).lattice;
  EXPECT_EQ(lattice.origin, (Vec3{0.25, 0.25, 0.25}));
  EXPECT_EQ(lattice.index_min, (Counts{-3, 1, 4}));
  EXPECT_EQ(lattice.counts, (Counts{6, 1, 1})) << "a flat side on a voxel's border still has one layer";
}

TEST(LatticeChoice, CentersKeepFlatSidesInTheirPlane) {
  EXPECT_EQ(choose(kSheet, sampled(LongestSide{4}, true)).lattice.coordinate(2, 0), 7.0);
  EXPECT_EQ(choose(kSheet, sampled(SampleCounts{{4, 4, 1}}, true)).lattice.coordinate(2, 0), 7.0);
}

TEST(LatticeChoice, BoundsReplaceTheMeshsBox) {
  LatticeRequest request = sampled(LongestSide{5});
  request.bounds = kBrick;
  EXPECT_EQ(choose(kUnit, request).lattice.origin, kBrick.lower);
}

TEST(LatticeChoice, PaddingInWorldUnitsWidensTheBoxBeforeSampling) {
  LatticeRequest request = sampled(LongestSide{5});
  request.padding = WorldPadding{0.5};
  const Lattice lattice = choose(kUnit, request).lattice;
  EXPECT_EQ(lattice.counts, (Counts{5, 5, 5}));
  EXPECT_EQ(lattice.origin, (Vec3{-0.5, -0.5, -0.5}));
  EXPECT_EQ(lattice.spacing, (Vec3{0.5, 0.5, 0.5}));
  EXPECT_EQ(lattice.index_min, (Counts{0, 0, 0}));
}

TEST(LatticeChoice, PaddingInVoxelsMovesNoSample) {
  LatticeRequest request = sampled(LongestSide{5});
  request.padding = VoxelPadding{3};
  const Lattice lattice = choose(kSheet, request).lattice;
  EXPECT_EQ(lattice.origin, kSheet.lower);
  EXPECT_EQ(lattice.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(lattice.index_min, (Counts{-3, -3, -3}));
  EXPECT_EQ(lattice.counts, (Counts{11, 9, 7}));
}

TEST(LatticeChoice, NegativePaddingNarrowsTheBox) {
  LatticeRequest request = sampled(LongestSide{5});
  request.padding = WorldPadding{-0.25};
  EXPECT_EQ(choose(kUnit, request).lattice.origin, (Vec3{0.25, 0.25, 0.25}));
  request.padding = VoxelPadding{-2};
  EXPECT_EQ(choose(kUnit, request).lattice.counts, (Counts{1, 1, 1}));
  EXPECT_EQ(choose(kUnit, request).lattice.index_min, (Counts{2, 2, 2}));
}

TEST(LatticeChoice, PaddingThatLeavesNothingIsAUsageError) {
  LatticeRequest request = sampled(LongestSide{5});
  request.padding = WorldPadding{-0.6};
  EXPECT_THROW(choose(kUnit, request), UsageError);
  request.padding = VoxelPadding{-3};
  EXPECT_THROW(choose(kUnit, request), UsageError);
}

TEST(LatticeChoice, WhatDoubleCannotHoldIsALimit) {
  const double huge = std::numeric_limits<double>::max();
  EXPECT_THROW(choose({{-huge, 0, 0}, {huge, 1, 1}}, {}), LimitError);
  EXPECT_THROW(choose({{0, 0, 0}, {5e-324, 0, 0}}, {}), LimitError);
  EXPECT_THROW(choose(kUnit, sampled(VoxelSize{{1e-300, 1, 1}})), LimitError);
  LatticeRequest request;
  request.padding = VoxelPadding{std::numeric_limits<std::int64_t>::max()};
  EXPECT_THROW(choose(kUnit, request), LimitError);
  LatticeRequest padded = sampled(VoxelSize{{1e308, 1e308, 1e308}});
  EXPECT_EQ(choose(kUnit, padded).lattice.counts, (Counts{2, 2, 2}));
  padded.padding = VoxelPadding{4};
  EXPECT_THROW(choose(kUnit, padded), LimitError);
}

TEST(SampleCount, IsTheProductOfTheCounts) {
  Lattice lattice;
  lattice.counts = {1000, 2000, 3000};
  EXPECT_EQ(sample_count(lattice), 6'000'000'000U);
}

TEST(SampleCount, BeyondSixtyFourBitsIsALimitWithTheNumber) {
  Lattice lattice;
  lattice.counts = {10'000'000'000, 10'000'000'000, 10'000'000'000};
  EXPECT_EQ(error_text<LimitError>([&] { return sample_count(lattice); }),
            "the lattice would have 1e+30 samples, expected less than 2^62");
}

TEST(SampleCount, BeyondThirtyTwoBitsAlongAnAxisIsALimitWithTheAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Lattice lattice;
    lattice.counts[axis] = 4'294'967'295;
    EXPECT_EQ(sample_count(lattice), 4'294'967'295U);
    ++lattice.counts[axis];
    EXPECT_EQ(error_text<LimitError>([&] { return sample_count(lattice); }),
              std::string("the lattice would have 4294967296 samples along ") + "xyz"[axis] +
                  ", expected at most 4294967295");
  }
}

}  // namespace
}  // namespace raycone::test
