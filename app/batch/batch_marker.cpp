#include "app/batch/batch_marker.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "io/files/file_error.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kBetweenSigns{60};
constexpr std::chrono::seconds kSilence{600};  // ten signs

std::string suffix_for(const std::string& options) {
  return std::string(kBatchSuffix) + sha256(options).substr(0, kHexadecimalDigits);
}

TemporaryFile mark(const std::string& directory, const std::string& suffix) try {
  return TemporaryFile(directory, suffix);
} catch (const std::system_error& error) {
  throw OutputError(directory + ": cannot create a file here: " + error.code().message());
}

// In seconds by the clock of the file system, which all hosts share.
std::optional<std::int64_t> last_sign(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return status.st_mtim.tv_sec;
}

// Whether the batch that `marker` is of still runs, as far as can be known.
bool is_at_work(const TemporaryName& name, const std::string& marker, const std::string& own) {
  if (is_abandoned(name)) return false;
  const std::optional<std::int64_t> sign = last_sign(marker);
  const std::optional<std::int64_t> now = last_sign(own);
  return sign && (!now || *now - *sign < kSilence.count());
}

}  // namespace

BatchMarker::BatchMarker(const std::string& directory, const std::string& options)
    : file_(mark(directory, suffix_for(options))), descriptor_(file_.take_descriptor()) {
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    const std::string path = entry->path().string();
    const std::optional<TemporaryName> name = temporary_name_from(entry->path().filename().native());
    if (!name || !name->suffix.starts_with(kBatchSuffix) || path == file_.path()) continue;
    if (!is_at_work(*name, path, file_.path())) {
      unlink(path.c_str());
    } else if (name->suffix != suffix_for(options)) {
      throw OutputError(directory + ": a batch with other options, or of another version, runs here (process " +
                        std::to_string(name->process) + "), expected to wait for it or to have another --out-dir");
    }
  }
}

void BatchMarker::renew() {
  const auto now = std::chrono::steady_clock::now();
  if (now - renewed_ < kBetweenSigns) return;
  futimens(descriptor_.number(), nullptr);
  renewed_ = now;
}

}  // namespace raycone
