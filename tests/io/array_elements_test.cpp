#include "io/fields/array_elements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace raycone {
namespace {

std::vector<std::uint16_t> halves_of(const FieldDescription& field, const std::vector<double>& numbers) {
  const std::unique_ptr<ArrayElements> elements = make_array_elements(field, Precision::kHalf, "out.npy");
  const std::span<const char> bytes = elements->in_order(std::span<const double>(numbers));
  std::vector<std::uint16_t> halves(bytes.size() / sizeof(std::uint16_t));
  std::memcpy(halves.data(), bytes.data(), bytes.size());
  return halves;
}

TEST(ArrayElements, HalvesStayOnTheirSideOfTheThreshold) {
  constexpr std::uint16_t kQuarter = 0x3400, kBelow = 0x33FF;  // 0.25 in 16 bits, and the number below it
  const double below = std::nextafter(0.25, 0.0);
  FieldDescription field;
  field.threshold = 0.25;
  EXPECT_EQ(halves_of(field, {0.25, below, 0.25 + 1e-9}), (std::vector<std::uint16_t>{kQuarter, kBelow, kQuarter}));
  field.threshold = 0.75;  // where nothing depends on the side of 0.25
  EXPECT_EQ(halves_of(field, {below}), std::vector<std::uint16_t>{kQuarter});
}

}  // namespace
}  // namespace raycone
