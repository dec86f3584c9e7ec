#include "app/batch/worker_failure.h"

#include <signal.h>
#include <sys/wait.h>

#include <cstring>

#include "app/batch/worker_process.h"
#include "app/process/exit_code.h"
#include "app/process/messages.h"
#include "app/process/own_process.h"
#include "io/files/readable_bytes.h"

namespace raycone {
namespace {

constexpr int kInternal = static_cast<int>(ExitCode::kInternal), kLimit = static_cast<int>(ExitCode::kLimit);

JobResult failed(MeshStatus status, int exit, const std::string& message) {
  JobResult result;
  result.row.status = status;
  result.row.exit = exit;
  result.row.message = message;
  return result;
}

JobResult crashed(const std::string& mesh, const std::string& what) {
  return failed(MeshStatus::kCrashed, kInternal, mesh + ": " + what);
}

JobResult killed_by(int signal, const std::string& mesh) {
  constexpr int kSignalBase = 128;  // as in shells
  const std::string hint = signal == SIGKILL ? ", perhaps by the system for lack of memory" : ", please report";
  return failed(
      MeshStatus::kCrashed, kSignalBase + signal,
      mesh + ": its process was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")" + hint);
}

JobResult not_started(const std::string& mesh, std::uint64_t memory_limit) {
  return failed(MeshStatus::kMemory, kLimit,
                mesh + ": its process could not start, for lack of memory (the limit is " +
                    readable_bytes(static_cast<double>(memory_limit)) + ") or of a library of raycone");
}

}  // namespace

JobResult timed_out(const std::string& mesh, double limit) {
  return failed(MeshStatus::kTimeout, kLimit, timeout_text(mesh, limit));
}

JobResult damaged_answer(const std::string& mesh) {
  return crashed(mesh, "the answer of its process is damaged, please report");
}

JobResult died(const std::string& mesh, int wait_status, std::uint64_t memory_limit) {
  if (wait_status == WorkerProcess::kDoesNotEnd) {
    return crashed(mesh, "its process does not end, though it was killed");
  }
  if (WIFSIGNALED(wait_status)) return killed_by(WTERMSIG(wait_status), mesh);
  const int exit_status = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 0;
  if (exit_status == kLimit) return failed(MeshStatus::kMemory, kLimit, out_of_memory_text(mesh, memory_limit));
  if (exit_status == kNotStarted) return not_started(mesh, memory_limit);
  if (exit_status == kNotExecuted) {
    return crashed(mesh, "raycone's own program cannot be executed any more, expected it where it was");
  }
  return crashed(mesh, "its process ended unexpectedly, please report");
}

}  // namespace raycone
