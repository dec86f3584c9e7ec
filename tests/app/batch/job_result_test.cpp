#include "app/batch/job_result.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace raycone::test {
namespace {

TEST(JobResult, IsTheSameBehindAMessage) {
  JobResult sent;
  sent.row.figures = MeshFigures{.faces = 12, .evaluate_s = 0.25};
  sent.row.sha256 = "0123";
  sent.row.warnings = "one two";
  sent.stamp = {1, -2, 3, 4, true};
  sent.knows_inputs = false;
  sent.buffers = {{.path = "x.bin", .sha256 = "abc"}};
  sent.grid = "def";
  sent.written = {{5, 6}, {}};
  sent.thumbnail = "iVBO";
  sent.warnings = {"one: a; b", "two: c"};
  const JobResult received = result_from(to_message(sent));
  EXPECT_EQ(received.row.figures->faces, 12U);
  EXPECT_EQ(received.row.figures->evaluate_s, 0.25);
  EXPECT_EQ(received.row.sha256, "0123");
  EXPECT_EQ(received.row.warnings, "one two");
  EXPECT_EQ(received.stamp, sent.stamp);
  EXPECT_TRUE(received.stamp.recent);
  EXPECT_FALSE(received.knows_inputs);
  EXPECT_EQ(received.buffers, sent.buffers);
  EXPECT_EQ(received.grid, "def");
  EXPECT_EQ(received.written, sent.written);
  EXPECT_EQ(received.thumbnail, "iVBO");
  EXPECT_EQ(received.warnings, sent.warnings);
}

TEST(JobResult, IsNotMadeOfAnotherMessage) { EXPECT_THROW((void)result_from({"a"}), std::runtime_error); }

}  // namespace
}  // namespace raycone::test
