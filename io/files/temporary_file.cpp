#include "io/files/temporary_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <vector>

#include "io/files/read_file.h"

namespace raycone {
namespace {

constexpr std::string_view kPrefix = ".raycone-";

// --- This process and others ----------------------------------------------------------------------------------------

std::string first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

// Empty where the system does not tell: then nobody's files can be told from ours.
std::string host_tag() {
  utsname names{};
  std::array<char, 64> processes{};
  const std::string boot = first_line("/proc/sys/kernel/random/boot_id");
  if (uname(&names) != 0 || boot.empty()) return "";
  if (readlink("/proc/self/ns/pid", processes.data(), processes.size() - 1) <= 0) return "";
  return sha256(std::string(names.nodename) + '\n' + boot + '\n' + processes.data()).substr(0, kHexadecimalDigits);
}

const std::string& this_host() {
  static const std::string tag = host_tag();
  return tag;
}

// What proc(5) calls state and starttime.
struct ProcessState {
  char state = '?';
  std::uint64_t start = 0;
};

// Nothing where there is no such process, or it may not be looked at.
std::optional<ProcessState> state_of(pid_t process) {
  const std::string line = first_line(("/proc/" + std::to_string(process) + "/stat").c_str());
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return std::nullopt;
  std::istringstream words(line.substr(end_of_name + 1));
  const std::vector<std::string> fields{std::istream_iterator<std::string>(words), {}};
  constexpr std::size_t kStart = 19;
  if (fields.size() <= kStart) return std::nullopt;
  ProcessState state{fields[0].front(), 0};
  const std::string& start = fields[kStart];
  std::from_chars(start.data(), start.data() + start.size(), state.start);
  return state;
}

TemporaryName next_name(const std::string& suffix) {
  static const std::uint64_t start = state_of(getpid()).value_or(ProcessState{}).start;
  static std::atomic<std::uint64_t> count{0};
  const std::string host = this_host().empty() ? std::string(kHexadecimalDigits, '0') : this_host();
  return {host, getpid(), start, count++, suffix};
}

// --- Names ----------------------------------------------------------------------------------------------------------

bool is_lower_hexadecimal(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_suffix(std::string_view text) {
  if (text.empty()) return true;
  return text.starts_with(kBatchSuffix) && text.size() == kBatchSuffix.size() + kHexadecimalDigits &&
         is_lower_hexadecimal(text.substr(kBatchSuffix.size()));
}

// Takes "-NUMBER" from the start of `text`.
template <typename Number>
bool take_number(std::string_view& text, Number& number) {
  if (!text.starts_with('-')) return false;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

// --- Files that a signal handler must remove ------------------------------------------------------------------------

// A fixed table in static storage, because a handler may neither allocate nor lock. Where all entries are taken a file
// is removed by its destructor only.
struct TemporaryFile::Entry {
  enum State { kFree, kFilling, kInUse };
  std::atomic<int> state{kFree};
  std::array<char, PATH_MAX> path{};

  static std::array<Entry, 32> table;

  static Entry* remember(const std::string& path) {
    if (path.size() >= PATH_MAX) return nullptr;
    for (Entry& entry : table) {
      int expected = kFree;
      if (!entry.state.compare_exchange_strong(expected, kFilling)) continue;
      std::memcpy(entry.path.data(), path.c_str(), path.size() + 1);
      entry.state = kInUse;
      return &entry;
    }
    return nullptr;
  }

  static void forget(Entry* entry) {
    if (entry != nullptr) entry->state = kFree;
  }

  static void remove_all() noexcept {
    for (const Entry& entry : table) {
      if (entry.state == kInUse) unlink(entry.path.data());
    }
  }
};

static_assert(std::atomic<int>::is_always_lock_free);
std::array<TemporaryFile::Entry, 32> TemporaryFile::Entry::table;

std::string TemporaryName::text() const {
  return std::string(kPrefix) + host + '-' + std::to_string(process) + '-' + std::to_string(start) + '-' +
         std::to_string(count) + suffix;
}

std::optional<TemporaryName> temporary_name_from(std::string_view text) {
  if (!text.starts_with(kPrefix)) return std::nullopt;
  TemporaryName name;
  std::string_view rest = text.substr(kPrefix.size());
  name.host = rest.substr(0, kHexadecimalDigits);
  if (name.host.size() < kHexadecimalDigits || !is_lower_hexadecimal(name.host)) return std::nullopt;
  rest.remove_prefix(kHexadecimalDigits);
  if (!take_number(rest, name.process) || !take_number(rest, name.start) || !take_number(rest, name.count)) {
    return std::nullopt;
  }
  name.suffix = rest;
  // Numbers may be written in other ways, which are not ours.
  return is_suffix(rest) && name.process > 0 && name.text() == text ? std::optional(name) : std::nullopt;
}

bool is_abandoned(const TemporaryName& name) {
  if (this_host().empty() || name.host != this_host()) return false;
  if (kill(name.process, 0) != 0) return errno == ESRCH;
  const std::optional<ProcessState> state = state_of(name.process);
  if (!state) return false;
  const bool ended = state->state == 'Z' || state->state == 'X';
  return ended || (name.start != 0 && state->start != 0 && name.start != state->start);
}

TemporaryFile::TemporaryFile(const std::string& directory, const std::string& suffix) {
  constexpr mode_t kMode = 0666;  // less the umask
  do {
    path_ = directory + '/' + next_name(suffix).text();
    Entry::forget(entry_);
    entry_ = Entry::remember(path_);  // before the file exists: a signal may arrive at any time
    descriptor_ = open_file(path_, O_WRONLY | O_CREAT | O_EXCL, kMode);
  } while (!descriptor_ && errno == EEXIST);
  if (descriptor_) return;
  const int error = errno;
  Entry::forget(entry_);
  throw std::system_error(error, std::generic_category());
}

TemporaryFile::~TemporaryFile() {
  descriptor_ = Descriptor();  // first: NFS keeps files that are open under other names
  if (!path_.empty()) unlink(path_.c_str());
  Entry::forget(entry_);
}

void TemporaryFile::renamed() {
  path_.clear();
  Entry::forget(std::exchange(entry_, nullptr));
}

void remove_temporary_files() noexcept {
  const int saved = errno;
  TemporaryFile::Entry::remove_all();
  errno = saved;
}

void remove_abandoned_files(const std::string& directory) {
  DIR* const entries = opendir(directory.c_str());
  if (entries == nullptr) return;
  while (const dirent* const entry = readdir(entries)) {
    const std::optional<TemporaryName> name = temporary_name_from(entry->d_name);
    if (name && is_abandoned(*name)) unlink((directory + '/' + entry->d_name).c_str());
  }
  closedir(entries);
}

}  // namespace raycone
