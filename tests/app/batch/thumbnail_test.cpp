#include "app/batch/thumbnail.h"
#include "core/data/lattice_slabs.h"

#include <gtest/gtest.h>

namespace raycone::test {
namespace {

// A lattice whose values are 1 where x >= nx / 2, else 0.
Lattice lattice_of(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  Lattice lattice;
  lattice.index_min = {-3, 0, 5};
  lattice.counts = {nx, ny, nz};
  return lattice;
}

std::vector<double> half_full(const Lattice& lattice, const LatticeBlock& block) {
  std::vector<double> values;
  for (std::int64_t n = 0; n < block.size(); ++n) {
    const std::int64_t i = n % block.counts[0] + block.first[0] - lattice.index_min[0];
    values.push_back(2 * i >= lattice.counts[0] ? 1.0 : 0.0);
  }
  return values;
}

int number_at(const std::string& bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes.at(at)) | static_cast<unsigned char>(bytes.at(at + 1)) << 8;
}

TEST(Thumbnail, IsTheSameWhicheverWayTheSlabsAreCut) {
  const Lattice lattice = lattice_of(20, 10, 4);
  Thumbnail at_once;
  at_once.add(lattice, whole(lattice), half_full(lattice, whole(lattice)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Thumbnail in_slabs;
    for (std::int64_t i = 0; i < lattice.counts[axis]; ++i) {
      const LatticeBlock slab = slab_of(whole(lattice), axis, i, 1);
      in_slabs.add(lattice, slab, half_full(lattice, slab));
    }
    EXPECT_EQ(in_slabs.bmp(), at_once.bmp());
  }
  const std::string bmp = at_once.bmp();
  EXPECT_EQ(bmp.substr(0, 2), "BM");
  EXPECT_EQ(number_at(bmp, 2), static_cast<int>(bmp.size()));
  EXPECT_EQ(number_at(bmp, 18), 20) << "pixels to the right: x";
  EXPECT_EQ(number_at(bmp, 22), 10) << "pixels upwards: y";
  const std::string row = bmp.substr(bmp.size() - 12, 10);  // of twenty pixels in three words
  EXPECT_EQ(row, std::string(5, '\x44') + std::string(5, '\xBB')) << "outside, then inside";
}

TEST(Thumbnail, LooksAlongTheShortestSideAndStaysSmall) {
  const Lattice lattice = lattice_of(1, 640, 320);
  Thumbnail thumbnail;
  thumbnail.add(lattice, whole(lattice), half_full(lattice, whole(lattice)));
  EXPECT_EQ(number_at(thumbnail.bmp(), 18), 64);
  EXPECT_EQ(number_at(thumbnail.bmp(), 22), 32);
  EXPECT_EQ(Thumbnail().bmp(), "");
}

}  // namespace
}  // namespace raycone::test
