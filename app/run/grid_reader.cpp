#include "app/run/grid_reader.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include "app/process/signals.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"

namespace raycone {
namespace {

// What the reader writes: one of these letters, and behind it the lattice or the message.
enum Outcome : char { kRead = 'r', kInvalid = 'i', kLimited = 'l', kOutOfMemory = 'm' };

std::string outcome_of_reading(const std::string& path, const std::string& name) {
  static_assert(std::is_trivially_copyable_v<Lattice>);
  try {
    const Lattice lattice = read_vdb_lattice(path, name);
    return std::string(1, kRead).append(reinterpret_cast<const char*>(&lattice), sizeof lattice);
  } catch (const InputError& error) {
    return std::string(1, kInvalid) + error.what();
  } catch (const LimitError& error) {
    return std::string(1, kLimited) + error.what();
  } catch (const std::bad_alloc&) {
    return std::string(1, kOutOfMemory);
  }
}

Lattice lattice_from(const std::string& path, const std::string& outcome) {
  if (outcome[0] == kInvalid) throw InputError(outcome.substr(1));
  if (outcome[0] == kLimited) throw LimitError(outcome.substr(1));
  if (outcome[0] == kOutOfMemory) throw std::bad_alloc();
  Lattice lattice;
  if (outcome.size() != 1 + sizeof lattice)
    throw InputError(path + ": cannot read: the process that does it was disturbed");
  std::memcpy(&lattice, outcome.data() + 1, sizeof lattice);
  return lattice;
}

// Also the dynamic linker's, where memory is short.
constexpr int kNotStarted = 127;

[[noreturn]] void fail(const std::string& path, const char* what) {
  throw LimitError(path + ": cannot " + what + ": " + std::generic_category().message(errno));
}

// In the child: async-signal-safe calls only.
[[noreturn]] void become_reader(int answer, pid_t parent, char* const* words) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  leave_signals_to_supervisor();
  if (getppid() != parent) _exit(1);  // it died before this could notice
  constexpr rlimit kNone{0, 0};
  setrlimit(RLIMIT_CORE, &kNone);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  fcntl(answer, F_SETFD, 0);  // stays open
  execv("/proc/self/exe", words);
  _exit(kNotStarted);
}

std::string read_to_end(int descriptor) {
  std::string bytes;
  char buffer[4096];
  for (;;) {
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count == 0 || (count < 0 && errno != EINTR)) return bytes;
    if (count > 0) bytes.append(buffer, static_cast<std::size_t>(count));
  }
}

// How it ended, for people; nothing where it ended well. Throws std::bad_alloc where it had no memory to say so itself.
std::string end_of(pid_t process) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) continue;
  if (WIFSIGNALED(state)) return strsignal(WTERMSIG(state));
  const int status = WEXITSTATUS(state);
  if (status == kNotStarted || status == static_cast<int>(ExitCode::kLimit)) throw std::bad_alloc();
  return status == 0 ? "" : "exit status " + std::to_string(status);
}

}  // namespace

ExitCode run_grid_reader(const std::vector<std::string>& words) {
  const std::string outcome = outcome_of_reading(words.at(1), words.at(2));
  const ssize_t written = write(std::stoi(words.at(0)), outcome.data(), outcome.size());
  return written == static_cast<ssize_t>(outcome.size()) ? ExitCode::kDone : ExitCode::kOutput;
}

Lattice read_grid_lattice(const std::string& path, const std::string& name) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail(path, "open a pipe");
  std::vector<std::string> words{"raycone", kGridReaderCommand, std::to_string(ends[1]), path, name};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  std::optional<HeldSignals> until_child_ignores_them(std::in_place);
  const pid_t process = fork();
  if (process == 0) become_reader(ends[1], parent, arguments.data());
  const int error = errno;
  until_child_ignores_them.reset();
  close(ends[1]);
  const std::string outcome = process > 0 ? read_to_end(ends[0]) : "";
  close(ends[0]);
  if (process < 0) {
    errno = error;
    fail(path, "start another process");
  }
  const std::string end = end_of(process);
  if (!end.empty()) throw InputError(path + ": not a readable OpenVDB file: it crashed OpenVDB (" + end + ")");
  return lattice_from(path, outcome);
}

}  // namespace raycone
