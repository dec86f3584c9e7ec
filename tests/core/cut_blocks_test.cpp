#include "core/evaluation/cut_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/lattice_rows.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// In the unit cube.
LatticeRows unit_rows(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
  const auto step = [](std::int64_t count) { return 1.0 / static_cast<double>(count); };
  return test::rows_of({{0, 0, 0}, {step(nx), step(ny), step(nz)}, {0, 0, 0}, {nx, ny, nz}});
}

// How often each sample is in a box.
class Cover {
 public:
  explicit Cover(const LatticeRows& rows) : rows_(rows), times_(rows.xs.size() * rows.size()) {}
  void add(const SampleBox& box) {
    for (std::size_t k = box.begin[2]; k < box.end[2]; ++k) {
      for (std::size_t j = box.begin[1]; j < box.end[1]; ++j) {
        for (std::size_t i = box.begin[0]; i < box.end[0]; ++i) {
          ++times_[(k * rows_.ys.size() + j) * rows_.xs.size() + i];
        }
      }
    }
  }
  [[nodiscard]] auto count(int times) const { return std::ranges::count(times_, times); }
  [[nodiscard]] auto size() const { return static_cast<std::ptrdiff_t>(times_.size()); }

 private:
  const LatticeRows& rows_;
  std::vector<int> times_;
};

TEST(CutBlocks, AreTheLattice) {
  const LatticeRows rows = unit_rows(100, 60, 97);
  const CutBlocks blocks(rows, {}, {});
  EXPECT_EQ(blocks.size(), 2U * 1 * 2);
  Cover cover(rows);
  for (std::size_t n = 0; n < blocks.size(); ++n) cover.add(blocks[n].samples);
  EXPECT_EQ(cover.count(1), cover.size());
}

TEST(CutBlocks, AreDividedIntoPartsThatAreAllOfThem) {
  const LatticeRows rows = unit_rows(50, 37, 5);
  const CutBlocks blocks(rows, {}, {});
  std::vector<CutBlock> waiting{blocks[0]}, parts;
  Cover cover(rows);
  std::size_t most_sides = 0;
  while (!waiting.empty()) {
    const CutBlock block = waiting.back();
    waiting.pop_back();
    if (block.samples.size() == 1) {
      cover.add(block.samples);
      continue;
    }
    parts.clear();
    blocks.divide(block, parts);
    ASSERT_GT(parts.size(), 1U);
    most_sides = std::max(most_sides, parts.size());
    waiting.insert(waiting.end(), parts.begin(), parts.end());
  }
  EXPECT_EQ(cover.count(1), cover.size());
  EXPECT_EQ(most_sides, 8U);
}

TEST(CutBlocks, ThatAreCutBecomeRows) {
  const LatticeRows rows = unit_rows(32, 16, 16);
  const FlatPiece cap = FlatPiece::of_triangle({0, 0, 0}, {1, 1, 0}, {1, 1, 1}, {{0, 0, 0}, {1, 1, 1}});
  const CutBlocks blocks(rows, {&cap, 1}, {FlatPiece::cone_of({2, 0, 0}, {2, 1, 1})});
  std::vector<CutBlock> waiting{blocks[0]}, parts;
  int rows_found = 0;
  while (!waiting.empty()) {
    CutBlock block = waiting.back();
    waiting.pop_back();
    blocks.forget_others(block, rows.box_of(block.samples));
    if (!block.is_cut()) {
      rows_found += block.is_row() && !block.caps.empty() && !block.cones.empty();
      continue;
    }
    EXPECT_EQ(block.samples.side(0), 32U);
    parts.clear();
    blocks.divide(block, parts);
    waiting.insert(waiting.end(), parts.begin(), parts.end());
  }
  EXPECT_GT(rows_found, 8);
}

// Points of pieces in the boxes of blocks.
TEST(CutBlocks, KnowThePiecesThatComeIn) {
  test::Random random(3);
  const LatticeRows rows = unit_rows(200, 100, 100);
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  std::vector<FlatPiece> caps, cones;
  std::vector<Vec3> in_cap, in_cone;
  for (int n = 0; n < 300; ++n) {
    const Vec3 a = test::uniform_point(random, unit), b = a + 0.1 * test::uniform_point(random, unit);
    const Vec3 c = a + 0.1 * test::uniform_point(random, unit);
    caps.push_back(FlatPiece::of_triangle(a, b, c, box_of(a, b, c)));
    in_cap.push_back(0.25 * a + 0.25 * b + 0.5 * c);
    cones.push_back(FlatPiece::cone_of(a, b));
    in_cone.push_back({test::uniform(random, 0, 1) * std::min(a.x, b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)});
  }
  const CutBlocks blocks(rows, caps, cones);
  int seen = 0;
  std::size_t listed = 0;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    CutBlock block = blocks[n];
    const Box box = rows.box_of(block.samples);
    blocks.forget_others(block, box);
    const auto holds = [](const std::vector<std::uint32_t>& all, std::uint32_t number) {
      return std::ranges::count(all, number) > 0;
    };
    for (std::uint32_t piece = 0; piece < caps.size(); ++piece) {
      if (square_of_gap(box, in_cap[piece]) == 0.0) {
        EXPECT_TRUE(holds(block.caps, piece));
        ++seen;
      }
      if (!block.caps.empty() && square_of_gap(box, in_cone[piece]) == 0.0) {
        EXPECT_TRUE(holds(block.cones, piece));
        ++seen;
      }
    }
    listed += block.caps.size();
  }
  EXPECT_GT(seen, 300);
  EXPECT_LT(listed, 4 * caps.size());
}

}  // namespace
}  // namespace raycone
