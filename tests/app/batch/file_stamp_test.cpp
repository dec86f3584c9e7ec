#include "app/batch/file_stamp.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/files/read_file.h"
#include "tests/support/temporary_directory.h"

namespace raycone::test {
namespace {

std::int64_t seconds_from_now(int count) {
  const auto time = std::chrono::system_clock::now().time_since_epoch() + std::chrono::seconds(count);
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
}

TEST(FileStamp, AFileThatMayHaveChangedSinceIsUnknown) {
  const TemporaryDirectory directory;
  const std::string path = directory / "a";
  std::ofstream(path) << "text";
  EXPECT_EQ(file_as_at(path, seconds_from_now(9)).sha256, sha256("text"));
  EXPECT_EQ(file_as_at(path, seconds_from_now(0)).sha256, "") << "times of files may be two seconds coarse";
  // Its time can be set, but not that of the change.
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_EQ(file_as_at(path, seconds_from_now(0)).sha256, "");
}

TEST(FileStamp, AMissingFileIsUnchangedUntilItIsThere) {
  const TemporaryDirectory directory;
  const std::string path = directory / "a";
  StampedFile file = file_as_at(path, seconds_from_now(0));
  EXPECT_EQ(file.sha256, kNoFile);
  EXPECT_TRUE(is_unchanged(file));
  EXPECT_TRUE(is_unchanged(file));
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_TRUE(is_unchanged(file)) << "no file that could be read";
  std::filesystem::remove(path);
  std::ofstream(path) << "text";
  EXPECT_FALSE(is_unchanged(file));
  StampedFile there = file_as_at(path, seconds_from_now(9));
  EXPECT_TRUE(is_unchanged(there));
  std::filesystem::remove(path);
  EXPECT_FALSE(is_unchanged(there));
  StampedFile unknown{.path = path};
  EXPECT_FALSE(is_unchanged(unknown));
}

}  // namespace
}  // namespace raycone::test
