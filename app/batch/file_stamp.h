// What tells whether a file is still the one that was read.
#pragma once

#include <cstdint>
#include <string>

namespace raycone {

// What tells it quickly: size and times, as stat(2) has them.
struct FileStamp {
  std::uint64_t size = 0;     // bytes; 0 where there is no file
  std::int64_t modified = 0;  // nanoseconds since 1970
  std::int64_t changed = 0;   // likewise, of content, attributes or name: what no program can set
  bool recent = false;        // taken so soon after that that a further change may have left the same times

  friend bool operator==(const FileStamp& a, const FileStamp& b) {
    return a.size == b.size && a.modified == b.modified && a.changed == b.changed;
  }
};

// To be taken before the file is read. All zeros where there is none.
[[nodiscard]] FileStamp stamp_of(const std::string& path);

// Whether the file is still the one of which `earlier` was taken. Where this is false its hash must tell.
[[nodiscard]] bool is_certainly_same(const FileStamp& earlier, const FileStamp& now);

// A stamp that is never certainly the same, for where there is a hash only.
inline constexpr FileStamp kNoStamp{0, 0, 0, true};

// Instead of a hash where no regular file can be read.
inline constexpr const char* kNoFile = "none";

// A file that was read or looked for, and the hash of what was there.
struct StampedFile {
  std::string path;
  FileStamp stamp = kNoStamp;
  std::string sha256{};  // or kNoFile; empty: unknown, no file is the same

  friend bool operator==(const StampedFile&, const StampedFile&) = default;
};

// Whether it holds what it held; its stamp is brought up to date then. Reads it where its stamp does not tell.
[[nodiscard]] bool is_unchanged(StampedFile& file);

// The file at `path`, its hash unknown where it may have changed since `time` (nanoseconds since 1970). Reads it.
[[nodiscard]] StampedFile file_as_at(const std::string& path, std::int64_t time);

}  // namespace raycone
