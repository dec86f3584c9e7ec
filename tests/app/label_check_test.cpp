#include "app/fields/label_check.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/fields/verify_by_definition.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// The unit cube, and another one that overlaps it.
const Vec3 kInFirst{0.25, 0.25, 0.25}, kInBoth{0.75, 0.75, 0.75}, kInSecond{1.25, 1.25, 1.25}, kOutside{3, 3, 3};

TriangleMesh cube_at(double corner) {
  return test::box_mesh({corner, corner, corner}, {corner + 1, corner + 1, corner + 1});
}

LabelCheck check_of(PartPriority priority) {
  std::vector<DrawnSample> samples;
  for (const Vec3& point : {kInFirst, kInBoth, kInSecond, kOutside}) samples.push_back({samples.size(), 0, point});
  LabelCheck check(samples, Rule{}, priority);
  check.add(cube_at(0.0));
  check.add(cube_at(0.5));
  return check;
}

TEST(LabelCheck, FindsThePartThatASampleIsIn) {
  EXPECT_EQ(check_of(PartPriority::kLast).compare("m", std::vector<std::int32_t>{1, 2, 2, 0}).samples, 4U);
  EXPECT_EQ(check_of(PartPriority::kFirst).compare("m", std::vector<std::int32_t>{1, 1, 2, 0}).samples, 4U);
}

TEST(LabelCheck, RefusesEveryWrongLabel) {
  const std::vector<std::int32_t> right{1, 2, 2, 0};
  for (std::size_t n = 0; n < right.size(); ++n) {
    std::vector<std::int32_t> wrong = right;
    wrong[n] = right[n] == 1 ? 0 : 1;
    EXPECT_THROW(static_cast<void>(check_of(PartPriority::kLast).compare("m", wrong)), VerificationError) << n;
  }
  EXPECT_THROW(static_cast<void>(check_of(PartPriority::kFirst).compare("m", right)), VerificationError);
}

}  // namespace
}  // namespace raycone
