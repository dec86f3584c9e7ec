#include "app/batch/worker.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "app/batch/command_message.h"
#include "app/batch/hash_inputs.h"
#include "app/batch/perform_job.h"
#include "app/process/memory_limit.h"
#include "app/process/message.h"
#include "app/process/signals.h"
#include "io/files/descriptor.h"

namespace raycone {
namespace {

// A job of many gigabytes must not leave the next one, perhaps in another worker, without memory.
void return_unused_memory(std::uint64_t used) {
  constexpr std::uint64_t kWorthReturning = std::uint64_t{64} << 20;
  if (used > kWorthReturning) malloc_trim(0);
}

// Allocations may fail where no exception can pass, as in a library's destructor.
[[noreturn]] void end_without_memory() {
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    _exit(static_cast<int>(ExitCode::kLimit));
  } catch (...) {
  }
  std::abort();
}

// The socket, out of the way of whatever reads standard input or prints.
Descriptor take_socket() {
  Descriptor socket(fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  dup2(open_file("/dev/null", O_RDONLY).number(), STDIN_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  return socket;
}

class Connection {
 public:
  explicit Connection(Descriptor socket) : socket_(std::move(socket)) {}

  // Waits; nothing at the end of the supervisor.
  std::optional<Message> receive() {
    for (;;) {
      if (std::optional<Message> message = reader_.next()) return message;
      char buffer[4096];
      const ssize_t count = recv(socket_.number(), buffer, sizeof buffer, 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return std::nullopt;
      reader_.add({buffer, static_cast<std::size_t>(count)});
    }
  }

  // False at the end of the supervisor.
  [[nodiscard]] bool send(const Message& message) const {
    const std::string frame = to_frame(message);
    for (std::size_t sent = 0; sent < frame.size();) {
      const ssize_t count = ::send(socket_.number(), frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      sent += static_cast<std::size_t>(count);
    }
    return true;
  }

 private:
  Descriptor socket_;
  MessageReader reader_;
};

JobResult answer_to(const Message& message) {
  if (const std::optional<InputsRequest> request = inputs_request_from(message)) return hash_inputs(*request);
  return perform_job(mesh_command_from(message));
}

}  // namespace

ExitCode run_worker() {
  ignore_interruptions();
  std::set_terminate(end_without_memory);
  Connection supervisor(take_socket());
  while (const std::optional<Message> message = supervisor.receive()) {
    if (!supervisor.send(to_message(answer_to(*message)))) break;
    return_unused_memory(peak_memory());
  }
  return ExitCode::kDone;
}

}  // namespace raycone
