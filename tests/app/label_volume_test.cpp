#include "app/fields/label_volume.h"

#include <gtest/gtest.h>

namespace raycone {
namespace {

const Lattice kLattice{{0, 0, 0}, {1, 1, 1}, {-3, 5, -1}, {4, 3, 2}};

// Of the whole lattice, x fastest.
std::vector<std::int32_t> labels_of(const LabelVolume& volume) {
  std::vector<std::int32_t> labels(24);
  volume.copy(whole(kLattice), labels);
  return labels;
}

TEST(LabelVolume, TheLastPartWinsUnlessTheFirstIsKept) {
  const LatticeBlock block{{-2, 6, 0}, {2, 2, 1}};
  const std::vector<std::uint8_t> all(24, 1), some{1, 0, 1, 1};
  for (const std::size_t parts : {200U, 60'000U, 70'000U}) {  // each stored in another type
    for (const PartPriority priority : {PartPriority::kLast, PartPriority::kFirst}) {
      const bool keeps = priority == PartPriority::kFirst;
      LabelVolume volume(kLattice, parts);
      const auto most = static_cast<std::int32_t>(parts);
      volume.add(block, some, most, priority);
      EXPECT_EQ(volume.counts()[parts], 3U);
      std::vector<std::int32_t> expected(24, 0);
      for (const std::size_t n : {17U, 21U, 22U}) expected[n] = most;
      EXPECT_EQ(labels_of(volume), expected);
      volume.add(whole(kLattice), all, 1, priority);
      for (std::int32_t& label : expected) label = keeps && label != 0 ? label : 1;
      EXPECT_EQ(labels_of(volume), expected);
      EXPECT_EQ(volume.at(17), keeps ? most : 1);
      std::vector<std::int32_t> part(4);
      volume.copy(block, part);
      EXPECT_EQ(part[1], 1);
      EXPECT_EQ(part[2], keeps ? most : 1);
    }
  }
}

TEST(LabelVolume, TakesAByteForFewParts) {
  EXPECT_EQ(LabelVolume::bytes(kLattice, 255), 24);
  EXPECT_EQ(LabelVolume::bytes(kLattice, 256), 48);
  EXPECT_EQ(LabelVolume::bytes(kLattice, 65'536), 96);
}

}  // namespace
}  // namespace raycone
