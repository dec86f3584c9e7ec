// Temporary files: removed whatever ends their process, and named so that others can tell whose they are.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/descriptor.h"

namespace raycone {

inline constexpr std::size_t kHexadecimalDigits = 16;  // of hashes in names

// What marks a directory as a running batch's (app/batch/batch_marker.h), with 16 hexadecimal digits behind it.
inline constexpr std::string_view kBatchSuffix = ".batch-";

// The name of a temporary file: ".raycone-HOST-PROCESS-START-COUNT", and for markers their suffix. HOST stands for all
// processes that can see each other: 16 hexadecimal digits made from the host's name, its boot and its namespace of
// processes. START is the time at which PROCESS started, in ticks since that boot, so that a number that is used again
// is no other's.
struct TemporaryName {
  std::string host;
  pid_t process = 0;
  std::uint64_t start = 0;
  std::uint64_t count = 0;
  std::string suffix{};

  [[nodiscard]] std::string text() const;
};

// Nothing for any name that raycone would not make.
[[nodiscard]] std::optional<TemporaryName> temporary_name_from(std::string_view text);

// Whether its process is one of this host, and has ended: nobody writes that file any more. What other hosts do cannot
// be known here.
[[nodiscard]] bool is_abandoned(const TemporaryName& name);

// Removes all TemporaryFiles that there are. Async-signal-safe: for signal handlers.
void remove_temporary_files() noexcept;

// A new file of mode 0666 less the umask, removed at the end of this, or by remove_temporary_files().
class TemporaryFile {
 public:
  // Throws std::system_error.
  explicit TemporaryFile(const std::string& directory, const std::string& suffix = "");
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  // Open for writing. Once.
  [[nodiscard]] Descriptor take_descriptor() { return std::move(descriptor_); }
  // It has got another name, and is no longer temporary.
  void renamed();

 private:
  struct Entry;
  friend void remove_temporary_files() noexcept;

  std::string path_;
  Entry* entry_ = nullptr;  // in the table for signal handlers
  Descriptor descriptor_;
};

// Removes the temporary files in `directory` that is_abandoned() tells of, and nothing else. Ignores errors.
void remove_abandoned_files(const std::string& directory);

}  // namespace raycone
