// What tells whether a file is still the one that was read or written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace raycone {

// What tells it quickly of a file that was read: what stat(2) has.
struct FileStamp {
  std::uint64_t size = 0;     // bytes; 0 where there is no file
  std::int64_t modified = 0;  // nanoseconds since 1970
  std::int64_t changed = 0;   // likewise, of content, attributes or name: what no program can set
  std::uint64_t inode = 0;    // of two files that were written within one tick of the clock
  bool recent = false;        // not to be trusted: taken so soon after a change that a further one may have left the
                              // same times, or while the file changed

  friend bool operator==(const FileStamp& a, const FileStamp& b) {
    return a.size == b.size && a.modified == b.modified && a.changed == b.changed && a.inode == b.inode;
  }
};

// To be taken before the file is read. All zeros where there is none.
[[nodiscard]] FileStamp stamp_of(const std::string& path);

// Whether the file is still the one of which `earlier` was taken. Where this is false its hash must tell.
[[nodiscard]] bool is_certainly_same(const FileStamp& earlier, const FileStamp& now);

// A stamp that is never certainly the same, for where there is a hash only.
inline constexpr FileStamp kNoStamp{0, 0, 0, 0, true};

// As text, for tables and messages: so many fields.
inline constexpr std::size_t kStampFields = 5;
[[nodiscard]] std::array<std::string, kStampFields> to_fields(const FileStamp& stamp);
// Nothing where these are no stamp.
[[nodiscard]] std::optional<FileStamp> stamp_from(std::span<const std::string, kStampFields> fields);

// Instead of a hash where no regular file can be read.
inline constexpr const char* kNoFile = "none";

// The hash of what is there, or kNoFile. Reads it, but only once as long as its stamp tells that it is the same. Not
// for several threads.
[[nodiscard]] std::string hash_of_file(const std::string& path);

// A file that was read or looked for, and the hash of what was there.
struct StampedFile {
  std::string path;
  FileStamp stamp = kNoStamp;
  std::string sha256{};  // or kNoFile; empty: unknown, no file is the same

  friend bool operator==(const StampedFile&, const StampedFile&) = default;
};

// Whether it holds what it held; its stamp is brought up to date then. Reads it where its stamp does not tell.
[[nodiscard]] bool is_unchanged(StampedFile& file);

// The file at `path`, its hash unknown where it may have changed since `time` (nanoseconds since 1970, by the clock of
// this host). Reads it.
[[nodiscard]] StampedFile file_as_at(const std::string& path, std::int64_t time);

// What tells whether a file is still the one that was written: neither renaming it nor a copy that keeps times matters.
// All zeros for what is no regular file.
struct OutputStamp {
  std::uint64_t size = 0;     // bytes
  std::int64_t modified = 0;  // nanoseconds since 1970

  friend bool operator==(const OutputStamp&, const OutputStamp&) = default;
};

[[nodiscard]] OutputStamp output_stamp_of(const std::string& path);

}  // namespace raycone
