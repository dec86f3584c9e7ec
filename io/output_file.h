// Output that appears under its name only when complete.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>

namespace raycone {

// Where output goes: a regular file (written to a temporary file beside it, synced and renamed by commit()), standard
// output ("-"), or a device, FIFO or /dev/fd/N, written to directly. A symbolic link is followed. The destructor
// removes an uncommitted temporary file; so does remove_temporary_files().
class OutputFile {
 public:
  // Opens at once, so that what cannot be written fails before the work. With no_clobber an existing file is an error.
  // Throws OutputError.
  explicit OutputFile(const std::string& path, bool no_clobber = false);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Appends, or goes on where seek() went; throws OutputError (a closed pipe raises SIGPIPE).
  void write(const void* data, std::size_t size);
  // Goes on at `offset`, which may lie behind all that has been written; only where seekable().
  void seek(std::uint64_t offset);
  // Replaces bytes already written; only where seekable().
  void overwrite(std::uint64_t offset, const void* data, std::size_t size);
  [[nodiscard]] bool seekable() const;
  // Hands buffered bytes to the system.
  void flush();
  // A stream of the same bytes for libraries that want one; valid while this object lives. Errors surface in commit().
  std::ostream& stream();
  // Flushes, syncs and renames. Throws OutputError. Nothing may follow.
  void commit();
  // As given on the command line.
  [[nodiscard]] const std::string& name() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Removes the temporary files of all open OutputFiles. Async-signal-safe: for signal handlers.
void remove_temporary_files() noexcept;

// Removes the temporary files in `directory` whose writers were killed, and never one that is being written, be it by
// another process or, where the file system's locks reach that far, on another host. Ignores errors.
void remove_abandoned_files(const std::string& directory);

}  // namespace raycone
