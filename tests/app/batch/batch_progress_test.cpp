#include "app/batch/batch_progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <regex>
#include <thread>

namespace raycone::test {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

// What is written about two meshes, the second of which fails, with a call of show() before and between them.
std::string written(BatchProgress::Style style, std::chrono::duration<double> between_lines,
                    std::chrono::milliseconds pause = {}) {
  testing::internal::CaptureStderr();
  {
    BatchProgress progress(style, 2, between_lines);
    progress.show();
    std::this_thread::sleep_for(pause);
    progress.add(MeshStatus::kOk, 0.5);
    progress.show();
    std::this_thread::sleep_for(pause);
    progress.add(MeshStatus::kInvalid, 1.0);
    progress.show();
  }
  return testing::internal::GetCapturedStderr();
}

TEST(BatchProgress, WritesLinesOfTheirOwnWhereThereIsNoTerminal) {
  const std::string text = written(BatchProgress::Style::kLines, seconds(0));
  EXPECT_EQ(std::ranges::count(text, '\n'), 5) << text;
  EXPECT_EQ(text.find_first_of("\r\033"), std::string::npos) << text;
  EXPECT_EQ(text.rfind("raycone: 0/2 meshes, 0 failed, ", 0), 0U) << text;
  EXPECT_NE(text.find("\nraycone: 1/2 meshes, 0 failed, "), std::string::npos) << text;
  EXPECT_TRUE(std::regex_search(text, std::regex("meshes/s, [0-9]+:[0-9][0-9] left\n"))) << text;
  EXPECT_NE(text.find("\nraycone: 2/2 meshes, 1 failed, "), std::string::npos) << text;
}

TEST(BatchProgress, WritesALineEachPeriodAndAtTheEnd) {
  const std::string text = written(BatchProgress::Style::kLines, hours(1));
  EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
  EXPECT_EQ(text.rfind("raycone: 2/2 meshes, 1 failed, ", 0), 0U) << text;
}

TEST(BatchProgress, RewritesOneLineOnATerminal) {
  const std::string text = written(BatchProgress::Style::kRewritten, hours(1), std::chrono::milliseconds(110));
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  EXPECT_NE(text.find("\r\033[K2/2 meshes"), std::string::npos) << text;
  const std::string hurried = written(BatchProgress::Style::kRewritten, hours(1));
  EXPECT_TRUE(hurried.starts_with("\r\033[K0/2 meshes")) << hurried;
  EXPECT_LE(std::ranges::count(hurried, '\r'), 4) << "not more often than people read: " << hurried;
  EXPECT_TRUE(text.ends_with("\r\033[K")) << text;
  EXPECT_EQ(written(BatchProgress::Style::kNone, seconds(0)), "");
}

}  // namespace
}  // namespace raycone::test
