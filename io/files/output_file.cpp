// Atomic output: everything goes to a temporary file in the target's directory, which rename(2) puts in its place.
#include "io/files/output_file.h"

#include <fcntl.h>  // fallocate
#include <stdio.h>  // renameat2
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "io/files/descriptor.h"
#include "io/files/file_buffer.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/file_time.h"
#include "io/files/readable_bytes.h"
#include "io/files/temporary_file.h"

namespace raycone {
namespace {

// --- Calls that differ from their POSIX namesakes -------------------------------------------------------------------

// What was reserved beyond the end. Where that cannot be done, no data are lost.
void give_back_room(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return;
  [[maybe_unused]] const int ignored = ftruncate(descriptor, status.st_size);
}

// Gives the open file the permissions of the file that it will replace, if there is one.
bool take_over_mode(int descriptor, const std::string& target) {
  struct stat ours {};
  struct stat theirs {};
  if (stat(target.c_str(), &theirs) != 0) return true;
  if (fstat(descriptor, &ours) != 0) return false;
  constexpr mode_t kPermissions = 0777;
  if (((ours.st_mode ^ theirs.st_mode) & kPermissions) == 0) return true;
  return fchmod(descriptor, theirs.st_mode & kPermissions) == 0;
}

// Renames without replacing anything: fails with EEXIST where `to` exists.
bool rename_to_new(const std::string& from, const std::string& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  // The file system (NFS) or kernel does not know how; a hard link does not replace either.
  return link(from.c_str(), to.c_str()) == 0 && unlink(from.c_str()) == 0;
}

}  // namespace

struct OutputFile::State {
  State(const std::string& path, Existing old, OutputGroup* with) : name(path), existing(old), group(with) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw OutputError((name == "-" ? "standard output" : name) + ": " + what);
  }
  [[noreturn]] void fail_writing(int error) const { fail("cannot write: " + std::generic_category().message(error)); }
  [[noreturn]] void fail_reserving(std::uint64_t bytes, double room) const {
    fail("cannot write: No space left on device: needs " + readable_bytes(static_cast<double>(bytes)) + " or more, " +
         readable_bytes(room) + " are free");
  }

  void open();
  void open_descriptor(int number);
  void open_special();
  void open_temporary();
  PlacedFile put_in_place();

  std::string name;
  Existing existing;
  OutputGroup* group;                      // or null
  std::string target;                      // `name` with links followed, where that is a regular file
  std::optional<TemporaryFile> temporary;  // absent where written to directly
  bool has_reserved = false;
  Descriptor file;       // what is written to
  Descriptor directory;  // of `target`, to be synced; none where it may be written to, but not opened
  std::optional<FileBuffer> buffer;
  std::ostream stream{nullptr};
};

void OutputFile::State::open() {
  target = follow_links(name);
  struct stat status {};
  // Of the name as given: a link to a pipe in another process's /proc/N/fd leads to one, but its text names no file.
  const bool exists = stat(name.c_str(), &status) == 0;
  if (name == "-") {
    open_descriptor(STDOUT_FILENO);
  } else if (const std::optional<int> number = descriptor_number(target)) {
    open_descriptor(*number);
  } else if (!exists && errno != ENOENT) {
    fail_writing(errno);
  } else if (exists && S_ISDIR(status.st_mode)) {
    fail("is a directory");
  } else if (exists && !S_ISREG(status.st_mode)) {
    open_special();
  } else if (exists && existing == Existing::kKept) {
    fail("already exists (--no-clobber)");
  } else {
    open_temporary();
  }
  buffer.emplace(file.number());
  stream.rdbuf(&*buffer);
}

// A duplicate, so that its last error is told by close() as well, and the original stays open for others.
void OutputFile::State::open_descriptor(int number) {
  constexpr int kLowest = 3;
  file = Descriptor(fcntl(number, F_DUPFD_CLOEXEC, kLowest));
  if (!file) fail_writing(errno);
  if ((fcntl(file.number(), F_GETFL) & O_ACCMODE) == O_RDONLY) fail_writing(EBADF);
}

void OutputFile::State::open_special() {
  file = open_file(name, O_WRONLY | O_NOCTTY);
  if (!file) fail_writing(errno);
}

void OutputFile::State::open_temporary() {
  const std::string path = directory_of(target);
  const auto fail_here = [&](int error) {
    fail("cannot create a file in " + path + ": " + std::generic_category().message(error));
  };
  directory = open_file(path, O_RDONLY | O_DIRECTORY);
  if (!directory && errno != EACCES) fail_here(errno);
  try {
    file = temporary.emplace(path).take_descriptor();
  } catch (const std::system_error& error) {
    fail_here(error.code().value());
  }
}

// Its size and time are asked for while no other process knows it: a rename leaves them.
PlacedFile OutputFile::State::put_in_place() {
  const std::string path = temporary->path();
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) fail_writing(errno);
  const bool renamed =
      existing == Existing::kKept ? rename_to_new(path, target) : rename(path.c_str(), target.c_str()) == 0;
  if (!renamed && errno == EEXIST) fail("already exists (--no-clobber)");
  if (!renamed) fail_writing(errno);
  temporary->renamed();
  if (directory && !write_to_disk(directory)) fail_writing(errno);
  return {name, static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim)};
}

OutputFile::OutputFile(const std::string& path, Existing existing, OutputGroup* group)
    : state_(std::make_shared<State>(path, existing, group)) {
  state_->open();
}

OutputFile::~OutputFile() = default;

// Reserved where the file system can do that, which tells of quotas, too, and keeps what others write meanwhile from
// taking the room; else its word for the free space must do. The file that will be replaced gives no room: it stays
// until the new one is complete.
void OutputFile::reserve(std::uint64_t bytes) {
  struct stat status {};
  struct statvfs disk {};
  const int descriptor = state_->file.number();
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return;
  const bool told = fstatvfs(descriptor, &disk) == 0 && disk.f_blocks > 0;
  const double room = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  if (told && room < static_cast<double>(bytes)) state_->fail_reserving(bytes, room);
  if (!state_->temporary || bytes > static_cast<std::uint64_t>(std::numeric_limits<off_t>::max())) return;
  state_->has_reserved = fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0;
  if (state_->has_reserved) return;
  if (errno == ENOSPC) state_->fail_reserving(bytes, room);
  if (errno == EDQUOT || errno == EFBIG) state_->fail_writing(errno);
}

void OutputFile::write(const void* data, std::size_t size) {
  const auto length = static_cast<std::streamsize>(size);
  if (state_->buffer->sputn(static_cast<const char*>(data), length) != length) {
    state_->fail_writing(state_->buffer->error());
  }
}

void OutputFile::seek(std::uint64_t offset) {
  const std::streampos there = static_cast<std::streamoff>(offset);
  if (state_->buffer->pubseekpos(there, std::ios_base::out) != there) state_->fail_writing(state_->buffer->error());
}

void OutputFile::overwrite(std::uint64_t offset, const void* data, std::size_t size) {
  FileBuffer& buffer = *state_->buffer;
  const std::streampos end = buffer.pubseekoff(0, std::ios_base::cur, std::ios_base::out);
  buffer.pubseekpos(static_cast<std::streamoff>(offset), std::ios_base::out);
  write(data, size);
  buffer.pubseekpos(end, std::ios_base::out);
}

bool OutputFile::seekable() const { return state_->temporary.has_value(); }

void OutputFile::flush() {
  if (state_->buffer->pubsync() != 0) state_->fail_writing(state_->buffer->error());
}

std::ostream& OutputFile::stream() { return state_->stream; }

void OutputFile::commit() {
  flush();
  State& state = *state_;
  if (state.temporary) {
    if (state.has_reserved) give_back_room(state.file.number());
    if (!take_over_mode(state.file.number(), state.target)) state.fail_writing(errno);
    if (!write_to_disk(state.file)) state.fail_writing(errno);
  }
  if (close(state.file.release()) != 0 && errno != EINTR) state.fail_writing(errno);
  if (!state.temporary) return;
  if (state.group) {
    state.group->waiting_.push_back(state_);
  } else {
    state.put_in_place();
  }
}

std::vector<PlacedFile> OutputGroup::commit() {
  std::vector<PlacedFile> placed;
  for (const auto& file : std::exchange(waiting_, {})) placed.push_back(file->put_in_place());
  return placed;
}

const std::string& OutputFile::name() const { return state_->name; }

}  // namespace raycone
