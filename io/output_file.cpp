// Atomic output: everything goes to a temporary file in the target's directory, which rename(2) puts in its place.
#include "io/output_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>  // renameat2
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <optional>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/file_buffer.h"
#include "io/file_error.h"

namespace raycone {
namespace {

// --- Temporary files that a signal handler must remove. A fixed table in static storage, because a handler may neither
// allocate nor lock. Where all entries are taken a file is removed by its destructor only.

struct TemporaryEntry {
  enum State { kFree, kFilling, kInUse };
  std::atomic<int> state{kFree};
  std::array<char, PATH_MAX> path{};
};
static_assert(std::atomic<int>::is_always_lock_free);
constexpr std::size_t kMaxTemporaries = 32;
std::array<TemporaryEntry, kMaxTemporaries> temporaries;

TemporaryEntry* remember_temporary(const std::string& path) {
  if (path.size() >= PATH_MAX) return nullptr;
  for (TemporaryEntry& entry : temporaries) {
    int expected = TemporaryEntry::kFree;
    if (!entry.state.compare_exchange_strong(expected, TemporaryEntry::kFilling)) continue;
    std::memcpy(entry.path.data(), path.c_str(), path.size() + 1);
    entry.state = TemporaryEntry::kInUse;
    return &entry;
  }
  return nullptr;
}

void forget_temporary(TemporaryEntry* entry) {
  if (entry != nullptr) entry->state = TemporaryEntry::kFree;
}

// --- Paths

std::string directory_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, std::max<std::size_t>(slash, 1));
}

// Where the symbolic link `path` points to; nothing for all else.
std::optional<std::string> link_target(const std::string& path) {
  std::array<char, PATH_MAX> target;
  const ssize_t length = readlink(path.c_str(), target.data(), target.size());
  if (length < 0) return std::nullopt;
  const std::string text(target.data(), static_cast<std::size_t>(length));
  return text.starts_with('/') ? text : directory_of(path) + '/' + text;
}

// The number N of /dev/fd/N and /proc/self/fd/N: descriptors that the caller opened for us.
std::optional<int> descriptor_number(std::string_view path) {
  for (const std::string_view prefix : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(prefix)) continue;
    const std::string_view digits = path.substr(prefix.size());
    int number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc() && end == digits.data() + digits.size() && number >= 0) return number;
  }
  return std::nullopt;
}

// `path` with symbolic links in its last component followed, also a dangling one, as far as a descriptor's name.
std::string follow_links(std::string path) {
  constexpr int kMaxLinks = 40;  // the kernel's own limit
  for (int i = 0; i < kMaxLinks && !descriptor_number(path); ++i) {
    std::optional<std::string> target = link_target(path);
    if (!target) break;
    path = std::move(*target);
  }
  return path;
}

constexpr std::string_view kTemporaryPrefix = ".raycone-";

// A name in the directory of `target` that nobody else uses: not even a process of the same number on another host or
// in another container that shares the directory.
std::string temporary_path(const std::string& target) {
  std::random_device random;
  return directory_of(target) + '/' + std::string(kTemporaryPrefix) + std::to_string(getpid()) + '-' +
         std::to_string(random());
}

// --- Whose temporary file is it? Its writer holds a lock (flock(2)) until it ends, however it ends.

// Whether the file is now ours: not where remove_abandoned_files() was faster than the lock. File systems without locks
// leave all as it is.
bool claim(int descriptor) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  struct stat status {};
  return fstat(descriptor, &status) != 0 || status.st_nlink > 0;
}

// Keeps the lock of a descriptor beyond its close(), which tells the last error of writing.
class LockKeeper {
 public:
  explicit LockKeeper(int original) : number_(fcntl(original, F_DUPFD_CLOEXEC, 0)) {}
  ~LockKeeper() {
    if (number_ >= 0) close(number_);
  }
  LockKeeper(const LockKeeper&) = delete;
  LockKeeper& operator=(const LockKeeper&) = delete;

 private:
  int number_;
};

void remove_if_abandoned(const std::string& path) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) unlink(path.c_str());
  close(descriptor);
}

// --- Calls that differ from their POSIX namesakes

bool write_to_disk(int descriptor) {
  // Some network and user-space file systems cannot sync, and say so in these two ways.
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS;
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
  State(const std::string& path, bool keep_existing) : name(path), no_clobber(keep_existing) {}
  ~State();

  [[noreturn]] void fail(const std::string& what) const {
    throw OutputError((name == "-" ? "standard output" : name) + ": " + what);
  }
  [[noreturn]] void fail_writing(int error) const { fail("cannot write: " + std::generic_category().message(error)); }

  void open();
  void open_descriptor(int number);
  void open_special();
  void open_temporary();
  void put_in_place();

  std::string name;
  bool no_clobber;
  std::string target;               // `name` with links followed
  std::string temporary;            // empty where written to directly, and once renamed
  TemporaryEntry* entry = nullptr;  // of `temporary`
  int descriptor = -1;
  std::optional<FileBuffer> buffer;
  std::ostream stream{nullptr};
};

OutputFile::State::~State() {
  if (descriptor >= 0) close(descriptor);
  if (!temporary.empty()) unlink(temporary.c_str());
  forget_temporary(entry);
}

void OutputFile::State::open() {
  target = follow_links(name);
  struct stat status {};
  const bool exists = stat(target.c_str(), &status) == 0;
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
  } else if (exists && no_clobber) {
    fail("already exists (--no-clobber)");
  } else {
    open_temporary();
  }
  buffer.emplace(descriptor);
  stream.rdbuf(&*buffer);
}

// A duplicate, so that its last error is told by close() as well, and the original stays open for others.
void OutputFile::State::open_descriptor(int number) {
  constexpr int kLowest = 3;
  descriptor = fcntl(number, F_DUPFD_CLOEXEC, kLowest);
  if (descriptor < 0) fail_writing(errno);
  if ((fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_RDONLY) fail_writing(EBADF);
}

void OutputFile::State::open_special() {
  do {
    descriptor = ::open(target.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) fail_writing(errno);
}

void OutputFile::State::open_temporary() {
  constexpr mode_t kMode = 0666;  // less the umask
  std::string path;
  for (;;) {
    path = temporary_path(target);
    forget_temporary(entry);
    entry = remember_temporary(path);  // before the file exists: a signal may arrive at any time
    descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
    if (descriptor >= 0 ? claim(descriptor) : errno != EEXIST) break;
    if (descriptor >= 0) close(descriptor);
  }
  if (descriptor < 0) {
    fail("cannot create a file in " + directory_of(target) + ": " + std::generic_category().message(errno));
  }
  temporary = path;
}

void OutputFile::State::put_in_place() {
  const bool renamed = no_clobber ? rename_to_new(temporary, target) : rename(temporary.c_str(), target.c_str()) == 0;
  if (!renamed && errno == EEXIST) fail("already exists (--no-clobber)");
  if (!renamed) fail_writing(errno);
  temporary.clear();
}

OutputFile::OutputFile(const std::string& path, bool no_clobber) : state_(std::make_unique<State>(path, no_clobber)) {
  state_->open();
}

OutputFile::~OutputFile() = default;

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

bool OutputFile::seekable() const { return !state_->temporary.empty(); }

void OutputFile::flush() {
  if (state_->buffer->pubsync() != 0) state_->fail_writing(state_->buffer->error());
}

std::ostream& OutputFile::stream() { return state_->stream; }

void OutputFile::commit() {
  flush();
  State& state = *state_;
  if (!state.temporary.empty()) {
    if (!take_over_mode(state.descriptor, state.target)) state.fail_writing(errno);
    if (!write_to_disk(state.descriptor)) state.fail_writing(errno);
  }
  const LockKeeper lock(state.descriptor);
  const int descriptor = std::exchange(state.descriptor, -1);
  if (close(descriptor) != 0 && errno != EINTR) state.fail_writing(errno);
  if (!state.temporary.empty()) state.put_in_place();
}

const std::string& OutputFile::name() const { return state_->name; }

void remove_temporary_files() noexcept {
  const int saved = errno;
  for (const TemporaryEntry& entry : temporaries) {
    if (entry.state == TemporaryEntry::kInUse) unlink(entry.path.data());
  }
  errno = saved;
}

void remove_abandoned_files(const std::string& directory) {
  DIR* const entries = opendir(directory.c_str());
  if (entries == nullptr) return;
  while (const dirent* const entry = readdir(entries)) {
    if (std::string_view(entry->d_name).starts_with(kTemporaryPrefix))
      remove_if_abandoned(directory + '/' + entry->d_name);
  }
  closedir(entries);
}

}  // namespace raycone
