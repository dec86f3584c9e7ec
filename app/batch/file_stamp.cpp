#include "app/batch/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

#include "app/text/parse_value.h"
#include "io/files/file_error.h"
#include "io/files/file_time.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

// The coarsest times are those of FAT; those of most file systems follow the kernel's clock, of 1 to 10 ms.
constexpr std::int64_t kCoarsestTime = 2'000'000'000;

std::string hash_of_content(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return kNoFile;  // a pipe would have to be waited for
  try {
    return sha256_of_file(path);
  } catch (const InputError&) {
    return kNoFile;
  }
}

}  // namespace

FileStamp stamp_of(const std::string& path) {
  const std::int64_t now = nanoseconds_now();  // before, so that a wait in between makes nothing look old
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  const std::int64_t modified = nanoseconds(status.st_mtim);
  const std::int64_t changed = nanoseconds(status.st_ctim);
  const bool recent = std::max(modified, changed) > now - kCoarsestTime;
  return {static_cast<std::uint64_t>(status.st_size), modified, changed, status.st_ino,
          S_ISREG(status.st_mode) && recent};
}

bool is_certainly_same(const FileStamp& earlier, const FileStamp& now) { return !earlier.recent && earlier == now; }

std::array<std::string, kStampFields> to_fields(const FileStamp& stamp) {
  return {std::to_string(stamp.size), std::to_string(stamp.modified), std::to_string(stamp.changed),
          std::to_string(static_cast<std::int64_t>(stamp.inode)), stamp.recent ? "1" : "0"};
}

std::optional<FileStamp> stamp_from(std::span<const std::string, kStampFields> fields) {
  std::array<std::int64_t, kStampFields> numbers{};
  for (std::size_t n = 0; n < kStampFields; ++n) {
    const std::optional<std::int64_t> number = integer_from(fields[n]);
    if (!number) return std::nullopt;
    numbers[n] = *number;
  }
  const auto [size, modified, changed, inode, recent] = numbers;
  return FileStamp{static_cast<std::uint64_t>(size), modified, changed, static_cast<std::uint64_t>(inode), recent != 0};
}

std::string hash_of_file(const std::string& path) {
  static std::map<std::string, StampedFile> known;
  StampedFile& file = known[path];
  const FileStamp now = stamp_of(path);
  if (file.path.empty() || !is_certainly_same(file.stamp, now)) file = {path, now, hash_of_content(path)};
  return file.sha256;
}

bool is_unchanged(StampedFile& file) {
  const FileStamp now = stamp_of(file.path);
  if (is_certainly_same(file.stamp, now)) return true;
  if (file.sha256.empty() || hash_of_file(file.path) != file.sha256) return false;
  file.stamp = now;
  return true;
}

StampedFile file_as_at(const std::string& path, std::int64_t time) {
  const FileStamp before = stamp_of(path);
  if (std::max(before.modified, before.changed) > time - kCoarsestTime) return {.path = path};
  const std::string content = hash_of_file(path);
  return {.path = path, .sha256 = stamp_of(path) == before ? content : ""};
}

OutputStamp output_stamp_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return {static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim)};
}

}  // namespace raycone
