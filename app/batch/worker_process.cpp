#include "app/batch/worker_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "app/batch/worker.h"
#include "app/process/exit_code.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// In the child: async-signal-safe calls only.
[[noreturn]] void become_worker(int socket, pid_t parent, char* const* words) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the supervisor died before this could notice
  dup2(socket, STDIN_FILENO);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv("/proc/self/exe", words);
  _exit(errno == ENOMEM || errno == EAGAIN ? kNotStarted : kNotExecuted);
}

}  // namespace

WorkerProcess::WorkerProcess() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw LimitError("cannot connect to a worker: " + std::generic_category().message(errno));
  }
  std::string program = "raycone";
  std::string command = kWorkerCommand;
  const std::array<char*, 3> words{program.data(), command.data(), nullptr};
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) become_worker(ends[1], parent, words.data());
  const int error = errno;
  close(ends[1]);
  socket_ = ends[0];
  if (process_ > 0) return;
  close(socket_);
  throw LimitError("cannot start a worker: " + std::generic_category().message(error));
}

WorkerProcess::~WorkerProcess() {
  end();
  close(socket_);
}

bool WorkerProcess::send(const Message& message) const {
  char answer = 0;  // none is due: what can be read is the end
  const ssize_t count = recv(socket_, &answer, sizeof answer, MSG_PEEK | MSG_DONTWAIT);
  if (count == 0 || (count < 0 && errno != EAGAIN)) return false;
  const std::string frame = to_frame(message);  // an idle worker's socket has room for it
  return ::send(socket_, frame.data(), frame.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(frame.size());
}

std::optional<JobResult> WorkerProcess::receive() {
  char buffer[65536];
  const ssize_t count = recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
  if (count <= 0) {
    ended_ = true;
    return std::nullopt;
  }
  reader_.add({buffer, static_cast<std::size_t>(count)});
  try {
    if (const std::optional<Message> message = reader_.next()) return result_from(*message);
  } catch (const std::exception&) {
    kill();
    ended_ = is_damaged_ = true;
  }
  return std::nullopt;
}

void WorkerProcess::kill() {
  if (process_ > 0) ::kill(process_, SIGKILL);
}

int WorkerProcess::end() {
  constexpr std::chrono::milliseconds kPause{1};
  constexpr int kPatience = 5000, kMost = 60000;  // pauses
  // One that closed its socket is ending by itself, and how is of interest.
  if (!ended_) kill();
  const pid_t process = std::exchange(process_, -1);
  if (process < 0) return 0;
  int status = 0;
  for (int n = 0; n < kMost; ++n) {
    const pid_t ended = waitpid(process, &status, WNOHANG);
    if (ended == process) return status;
    if (ended < 0 && errno != EINTR) return 0;
    if (n == kPatience) ::kill(process, SIGKILL);
    std::this_thread::sleep_for(kPause);
  }
  return kDoesNotEnd;
}

}  // namespace raycone
