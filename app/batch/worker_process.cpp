#include "app/batch/worker_process.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "app/batch/worker.h"
#include "app/process/own_process.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// In the child. Signals that a batch holds back are its supervisor's.
void prepare_worker(const Descriptor& socket) {
  dup2(socket.number(), STDIN_FILENO);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace

WorkerProcess::WorkerProcess() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw LimitError("cannot connect to a worker: " + std::generic_category().message(errno));
  }
  socket_ = Descriptor(ends[0]);
  const Descriptor others(ends[1]);
  try {
    process_ = start_anew({kWorkerCommand}, [&others] { prepare_worker(others); });
  } catch (const std::system_error& error) {
    throw LimitError("cannot start a worker: " + error.code().message());
  }
}

WorkerProcess::~WorkerProcess() { end(); }

bool WorkerProcess::send(const Message& message) const {
  char answer = 0;  // none is due: what can be read is the end
  const ssize_t count = recv(socket_.number(), &answer, sizeof answer, MSG_PEEK | MSG_DONTWAIT);
  if (count == 0 || (count < 0 && errno != EAGAIN)) return false;
  const std::string frame = to_frame(message);  // an idle worker's socket has room for it
  return ::send(socket_.number(), frame.data(), frame.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(frame.size());
}

std::optional<JobResult> WorkerProcess::receive() {
  char buffer[65536];
  const ssize_t count = recv(socket_.number(), buffer, sizeof buffer, MSG_DONTWAIT);
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
