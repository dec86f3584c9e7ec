#include "io/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "io/file_error.h"

namespace raycone {
namespace {

[[noreturn]] void fail(const char* what) {
  throw LimitError(std::string("cannot ") + what + ": " + std::generic_category().message(errno));
}

class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_, O_CLOEXEC) != 0) fail("open a pipe");
  }
  ~Pipe() {
    close(ends_[0]);
    close_write_end();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close_write_end() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }

  // Whether all of it was written.
  [[nodiscard]] bool write(const std::string& bytes) const {
    for (std::size_t written = 0; written < bytes.size();) {
      const ssize_t count = ::write(ends_[1], bytes.data() + written, bytes.size() - written);
      if (count < 0 && errno != EINTR) return false;
      if (count > 0) written += static_cast<std::size_t>(count);
    }
    return true;
  }

  [[nodiscard]] std::string read_to_end() const {
    std::string bytes;
    char buffer[4096];
    for (;;) {
      const ssize_t count = read(ends_[0], buffer, sizeof buffer);
      if (count == 0 || (count < 0 && errno != EINTR)) return bytes;
      if (count > 0) bytes.append(buffer, static_cast<std::size_t>(count));
    }
  }

 private:
  int ends_[2];
};

// While this lives, this thread takes no signals, nor does a child made meanwhile.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

// Ends without what a process does at its end: files and threads are the parent's.
[[noreturn]] void run_in_child(const std::function<std::string()>& work, const Pipe& result, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before this could notice
  constexpr rlimit kNone{0, 0};
  setrlimit(RLIMIT_CORE, &kNone);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  try {
    _exit(result.write(work()) ? 0 : 1);
  } catch (...) {
    _exit(1);
  }
}

pid_t start_child(const std::function<std::string()>& work, const Pipe& result) {
  const BlockedSignals blocked;
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) run_in_child(work, result, parent);
  return child;
}

int wait_for(pid_t child) {
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) continue;
  return state;
}

}  // namespace

std::string in_child_process(const std::function<std::string()>& work) {
  Pipe result;
  const pid_t child = start_child(work, result);
  if (child < 0) fail("start another process");
  result.close_write_end();
  std::string bytes = result.read_to_end();
  const int state = wait_for(child);
  if (WIFSIGNALED(state)) throw ChildDied(strsignal(WTERMSIG(state)));
  if (WEXITSTATUS(state) != 0) throw ChildDied("exit status " + std::to_string(WEXITSTATUS(state)));
  return bytes;
}

}  // namespace raycone
