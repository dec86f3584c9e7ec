#include "app/batch/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>

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
  try {
    if (file.sha256.empty() || sha256_of_file(file.path) != file.sha256) return false;
  } catch (const InputError&) {
    return false;
  }
  file.stamp = now;
  return true;
}

}  // namespace raycone
