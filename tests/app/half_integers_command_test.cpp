// Samples in the plane of a flat opening, from mesh to files, whatever the axis. Black box: the real executable.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "tests/app/csv_numbers.h"
#include "tests/app/meshes.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

// A unit cube without the face at 1 of an axis.
std::string cup_along(std::size_t axis) {
  std::string text;
  for (int n = 0; n < 8; ++n) {
    const std::array<int, 3> across{n / 4, n / 2 % 2, n % 2};  // the axis first
    text += "v";
    for (std::size_t i = 0; i < 3; ++i) text += ' ' + std::to_string(across[(i + 3 - axis) % 3]);
    text += '\n';
  }
  return text + "f 1 2 4 3\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
}

class OpeningOfACup : public testing::TestWithParam<std::size_t> {
 protected:
  OpeningOfACup() { write_text(cup_, cup_along(GetParam())); }

  TemporaryDirectory dir_;
  std::string cup_ = dir_ / "cup.obj";
};

TEST_P(OpeningOfACup, IsInside) {
  const CommandResult result = run_raycone({"lattice", cup_, "-o", "-", "--resolution", "28", "--padding", "2v",
                                            "--field", "winding,inside,sdf", "--verify", "50", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  int within = 0, around = 0;
  for (const std::vector<double>& row : csv_numbers(result.out).rows) {
    ASSERT_EQ(row.size(), 9U);
    const std::size_t axis = GetParam();
    if (row[3 + axis] != 1) continue;
    const double a = row[3 + (axis + 1) % 3], b = row[3 + (axis + 2) % 3];
    const bool is_within = a > 0 && a < 1 && b > 0 && b < 1, is_around = a < 0 || a > 1 || b < 0 || b > 1;
    within += is_within;
    around += is_around;
    if (is_within) {
      EXPECT_EQ(row[6], 0.5);
      EXPECT_EQ(row[7], 1);
      EXPECT_LT(row[8], 0);
    } else if (is_around) {
      EXPECT_NEAR(row[6], 0, 1e-14);  // an integer of an open mesh is a sum that rounds
      EXPECT_EQ(row[7], 0);
      EXPECT_GT(row[8], 0);
    }
  }
  EXPECT_EQ(within, 26 * 26);
  EXPECT_EQ(around, 32 * 32 - 28 * 28);
}

TEST_P(OpeningOfACup, IsOneHalfInSlices) {
  const std::string values = dir_ / "values.npy", axis(1, "xyz"[GetParam()]);
  const CommandResult result = run_raycone(
      {"slice", cup_, "-o", dir_ / "slice.png", "--axis", axis, "--at", "1", "--size", "28", "--values", values});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string bytes = read_text(values);
  ASSERT_EQ(bytes.size(), 128 + 28 * 28 * sizeof(double));
  for (std::size_t at = 128; at < bytes.size(); at += sizeof(double)) {
    double value = 0;
    std::memcpy(&value, &bytes[at], sizeof value);
    EXPECT_EQ(value, 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Axes, OpeningOfACup, testing::Values(0, 1, 2));

}  // namespace
}  // namespace raycone::test
