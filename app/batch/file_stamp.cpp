#include "app/batch/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "io/files/file_error.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
// The coarsest times are those of FAT; those of most file systems follow the kernel's clock, of 1 to 10 ms.
constexpr std::int64_t kCoarsestTime = 2 * kSecond;

std::int64_t nanoseconds(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * kSecond + static_cast<std::int64_t>(time.tv_nsec);
}

std::string content_of(const std::string& path) {
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
  const auto now =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {};
  const std::int64_t modified = nanoseconds(status.st_mtim);
  const std::int64_t changed = nanoseconds(status.st_ctim);
  const bool recent = std::max(modified, changed) > now.count() - kCoarsestTime;
  return {static_cast<std::uint64_t>(status.st_size), modified, changed, S_ISREG(status.st_mode) && recent};
}

bool is_certainly_same(const FileStamp& earlier, const FileStamp& now) { return !earlier.recent && earlier == now; }

bool is_unchanged(StampedFile& file) {
  const FileStamp now = stamp_of(file.path);
  if (is_certainly_same(file.stamp, now)) return true;
  if (file.sha256.empty() || content_of(file.path) != file.sha256) return false;
  file.stamp = now;
  return true;
}

StampedFile file_as_at(const std::string& path, std::int64_t time) {
  const FileStamp before = stamp_of(path);
  if (std::max(before.modified, before.changed) > time - kCoarsestTime) return {.path = path};
  const std::string content = content_of(path);
  return {.path = path, .sha256 = stamp_of(path) == before ? content : ""};
}

}  // namespace raycone
