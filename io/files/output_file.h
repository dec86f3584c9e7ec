// Output that appears under its name only when complete.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace raycone {

class OutputGroup;

// A regular file as it was put in its place.
struct PlacedFile {
  std::string name;           // as given on the command line
  std::uint64_t size = 0;     // bytes
  std::int64_t modified = 0;  // nanoseconds since 1970
};

// What becomes of a file that has the output's name already.
enum class Existing {
  kReplaced,  // when the output is complete
  kKept,      // the output is an error (--no-clobber)
};

// Where output goes: a regular file (written to a temporary file beside it, synced and renamed by commit()), standard
// output ("-"), or a device, FIFO or /dev/fd/N, written to directly. A symbolic link is followed. The destructor
// removes an uncommitted temporary file; so does remove_temporary_files() (io/files/temporary_file.h).
class OutputFile {
 public:
  // Opens at once, so that what cannot be written fails before the work.
  // The `group`, if any, must outlive this. Throws OutputError.
  explicit OutputFile(const std::string& path, Existing existing = Existing::kReplaced, OutputGroup* group = nullptr);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Makes sure of room for `bytes` in all, before the first is written: throws OutputError where the file system tells
  // that there is none, or that a quota or limit forbids it. Nothing for pipes and devices.
  void reserve(std::uint64_t bytes);
  // Appends, or goes on where seek() went; throws OutputError (a closed pipe raises SIGPIPE).
  void write(const void* data, std::size_t size);
  // Goes on at `offset`, which may lie behind all that has been written; only where seekable(), unless it is there.
  void seek(std::uint64_t offset);
  // Replaces bytes already written; only where seekable().
  void overwrite(std::uint64_t offset, const void* data, std::size_t size);
  [[nodiscard]] bool seekable() const;
  // Hands buffered bytes to the system.
  void flush();
  // A stream of the same bytes for libraries that want one; valid while this object lives. Errors surface in commit().
  std::ostream& stream();
  // Flushes, syncs, renames and syncs the directory. Throws OutputError: where that last step fails, the file is in its
  // place already, but a loss of power may undo it. Nothing may follow. In a group the file is not renamed yet.
  void commit();
  // As given on the command line.
  [[nodiscard]] const std::string& name() const;

 private:
  friend class OutputGroup;
  struct State;
  std::shared_ptr<State> state_;
};

// Writes all that it is to hold, and commits it.
inline void write_all(OutputFile& file, std::string_view text) {
  file.write(text.data(), text.size());
  file.commit();
}

// Files that appear together: those that have been committed wait for commit() of the group. Where one of them cannot
// be written, none appears; only one that cannot be renamed has others before it in place. Members may be destroyed
// before.
class OutputGroup {
 public:
  // Renames them, in the order in which they were committed, and returns them. Throws OutputError; those before are in
  // place then.
  std::vector<PlacedFile> commit();

 private:
  friend class OutputFile;
  std::vector<std::shared_ptr<OutputFile::State>> waiting_;
};

}  // namespace raycone
