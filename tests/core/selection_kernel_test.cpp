// Triangles by their keys, at all levels of SIMD, against the standard library.
#include "core/mesh/selection_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace raycone {
namespace {

using PlacedTriangle = std::array<std::uint32_t, 4>;  // three places, and the number

constexpr std::array kSimdLevels{SimdLevel::kBest, SimdLevel::kSse4, SimdLevel::kAvx2, SimdLevel::kAvx512};

// Triangles in columns, between others that are to stay as they are.
class Columns {
 public:
  explicit Columns(const std::vector<PlacedTriangle>& placed) : count_(placed.size()) {
    for (std::size_t c = 0; c < 4; ++c) {
      columns_[c].assign(count_ + 2 * kAside, kUntouched);
      for (std::size_t n = 0; n < count_; ++n) columns_[c][kAside + n] = placed[n][c];
    }
  }

  PlacedTriangles triangles() {
    const auto at = [&](std::size_t c) { return columns_[c].data() + kAside; };
    return {{at(0), at(1), at(2)}, at(3)};
  }
  [[nodiscard]] std::vector<PlacedTriangle> placed() const {
    std::vector<PlacedTriangle> placed(count_);
    for (std::size_t n = 0; n < count_; ++n) {
      for (std::size_t c = 0; c < 4; ++c) placed[n][c] = columns_[c][kAside + n];
    }
    return placed;
  }
  [[nodiscard]] bool is_untouched_aside() const {
    return std::ranges::all_of(columns_, [&](const std::vector<std::uint32_t>& column) {
      return std::ranges::count(column, kUntouched) == 2 * static_cast<std::ptrdiff_t>(kAside);
    });
  }

 private:
  static constexpr std::size_t kAside = 32;  // more than a vector
  static constexpr std::uint32_t kUntouched = 0xdeadbeef;
  std::size_t count_;
  std::array<std::vector<std::uint32_t>, 4> columns_;
};

std::uint64_t key(const PlacedTriangle& placed, std::size_t axis) {
  return std::uint64_t{placed[axis]} << 32 | placed[3];
}

// Numbers are each used once, up to the largest there are; `places` values of places.
std::vector<PlacedTriangle> random_triangles(std::size_t count, std::uint32_t places, std::mt19937& random) {
  std::vector<PlacedTriangle> placed(count);
  const auto place = [&] { return static_cast<std::uint32_t>(random() % places) * (0x40000000U / places); };
  for (std::size_t n = 0; n < count; ++n) {
    placed[n] = {place(), place(), place(),
                 n % 2 == 0 ? static_cast<std::uint32_t>(n) : ~static_cast<std::uint32_t>(n)};
  }
  std::ranges::shuffle(placed, random);
  return placed;
}

TEST(SelectionKernel, PartsAsTheStandardLibraryDoes) {
  std::mt19937 random(1);
  for (const std::size_t count : {1U, 3U, 15U, 16U, 17U, 64U, 100U, 333U}) {
    for (const std::uint32_t places : {1U, 5U, 0x40000000U}) {
      const std::vector<PlacedTriangle> placed = random_triangles(count, places, random);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint64_t pivot = key(placed[random() % count], axis);
        std::vector<PlacedTriangle> expected = placed;
        const auto middle =
            std::ranges::stable_partition(expected, [&](const PlacedTriangle& p) { return key(p, axis) < pivot; });
        for (const SimdLevel level : kSimdLevels) {
          Columns columns(placed), room(std::vector<PlacedTriangle>(count, PlacedTriangle{}));
          const std::size_t below =
              selection_kernel(level).partition(columns.triangles(), room.triangles(), count, axis, pivot);
          EXPECT_EQ(below, static_cast<std::size_t>(middle.begin() - expected.begin()));
          EXPECT_EQ(columns.placed(), expected);
          EXPECT_TRUE(columns.is_untouched_aside() && room.is_untouched_aside());
        }
      }
    }
  }
}

TEST(SelectionKernel, SortsAsTheStandardLibraryDoes) {
  std::mt19937 random(2);
  for (std::size_t count = 1; count <= kMostSorted; ++count) {
    for (const std::uint32_t places : {1U, 5U, 0x40000000U}) {
      const std::vector<PlacedTriangle> placed = random_triangles(count, places, random);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<PlacedTriangle> expected = placed;
        std::ranges::sort(expected, {}, [&](const PlacedTriangle& p) { return key(p, axis); });
        for (const SimdLevel level : kSimdLevels) {
          Columns columns(placed);
          selection_kernel(level).sort_few(columns.triangles(), count, axis);
          EXPECT_EQ(columns.placed(), expected);
          EXPECT_TRUE(columns.is_untouched_aside());
        }
      }
    }
  }
}

}  // namespace
}  // namespace raycone
