#include "app/batch/file_stamp.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
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

// Two files that were written within one tick of the clock.
TEST(FileStamp, AnotherInodeIsAnotherFile) {
  EXPECT_TRUE(is_certainly_same({1, 2, 3, 4}, {1, 2, 3, 4}));
  EXPECT_FALSE(is_certainly_same({1, 2, 3, 4}, {1, 2, 3, 5}));
  const TemporaryDirectory directory;
  std::ofstream(directory / "a") << "text";
  std::ofstream(directory / "b") << "text";
  EXPECT_NE(stamp_of(directory / "a").inode, stamp_of(directory / "b").inode);
}

TEST(FileStamp, ArrivesAsFields) {
  const FileStamp stamp{1, -2, 3, UINT64_MAX, true};
  auto fields = to_fields(stamp);
  const std::optional<FileStamp> read = stamp_from(fields);
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, stamp);
  EXPECT_TRUE(read->recent);
  fields[1] = "";
  EXPECT_FALSE(stamp_from(fields));
}

TEST(FileStamp, ContentIsReadAnewWhereItsFileChanged) {
  const TemporaryDirectory directory;
  const std::string path = directory / "a";
  std::ofstream(path) << "one";
  EXPECT_EQ(hash_of_file(path), sha256("one"));
  std::ofstream(path) << "two";
  EXPECT_EQ(hash_of_file(path), sha256("two")) << "of the same size, perhaps within one tick";
  std::filesystem::remove(path);
  EXPECT_EQ(hash_of_file(path), kNoFile);
}

TEST(FileStamp, OutputsAreKnownBySizeAndTime) {
  const TemporaryDirectory directory;
  const std::string path = directory / "a";
  std::ofstream(path) << "text";
  const OutputStamp stamp = output_stamp_of(path);
  EXPECT_EQ(stamp.size, 4U);
  EXPECT_EQ(stamp.modified, stamp_of(path).modified);
  std::filesystem::rename(path, directory / "b");
  EXPECT_EQ(output_stamp_of(directory / "b"), stamp);
  for (const std::string& none : {path, directory.path().string(), std::string("/dev/null")}) {
    EXPECT_EQ(output_stamp_of(none), OutputStamp{}) << none;
  }
}

}  // namespace
}  // namespace raycone::test
