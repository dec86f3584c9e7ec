#include "app/batch/worker.h"

#include <fcntl.h>
#include <malloc.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "app/batch/command_message.h"
#include "app/batch/job_result.h"
#include "app/batch/thumbnail.h"
#include "app/options/batch_command.h"
#include "app/process/limits.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "app/report/run_report.h"
#include "app/run/run_lattice.h"
#include "app/run/run_limits.h"
#include "app/run/run_points.h"
#include "app/run/written_files.h"
#include "core/machine/threads.h"
#include "io/files/base64.h"
#include "io/files/file_error.h"
#include "io/files/read_file.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

// The peak of memory counts from here on: each job has its own.
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << '5'; }

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
int take_socket() {
  const int socket = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  close(nothing);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  return socket;
}

class Connection {
 public:
  explicit Connection(int socket) : socket_(socket) {}

  // Waits; nothing at the end of the supervisor.
  std::optional<Message> receive() {
    for (;;) {
      if (std::optional<Message> message = reader_.next()) return message;
      char buffer[4096];
      const ssize_t count = recv(socket_, buffer, sizeof buffer, 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return std::nullopt;
      reader_.add({buffer, static_cast<std::size_t>(count)});
    }
  }

  // False at the end of the supervisor.
  [[nodiscard]] bool send(const Message& message) const {
    const std::string frame = to_frame(message);
    for (std::size_t sent = 0; sent < frame.size();) {
      const ssize_t count = ::send(socket_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      sent += static_cast<std::size_t>(count);
    }
    return true;
  }

 private:
  int socket_;
  MessageReader reader_;
};

MeshFigures figures_of(const RunReport& report) {
  const Seconds& seconds = report.seconds;
  return {report.faces,
          report.exterior_edges,
          report.samples,
          report.tally.degenerate,
          report.tally.on_surface,
          seconds.read,
          seconds.prepare,
          seconds.evaluate,
          seconds.write,
          report.peak_memory_bytes,
          report.orientation.flipped_faces,
          report.orientation.dropped_duplicates,
          report.orientation.patches};
}

// `thumbnail`: BMP; empty where there is none.
JobResult result_of(const RunReport& report, const std::string& thumbnail) {
  JobResult result;
  result.row.figures = figures_of(report);
  result.row.sha256 = report.sha256;
  for (const Warning& warning : report.warnings) {
    result.warnings.push_back(line_of(warning));
    result.row.message += (result.row.message.empty() ? "" : "; ") + result.warnings.back();
    result.row.warnings += (result.row.warnings.empty() ? "" : " ") + warning.name;
  }
  result.thumbnail = to_base64(thumbnail);
  for (const FileRead& file : report.companions)
    result.companions.push_back({.path = file.path, .sha256 = file.sha256});
  return result;
}

// Of the grid of --like, which is read by another process, job after job. It is hashed again where its stamp differs.
std::string hash_of_grid(const std::string& path) {
  static StampedFile known;
  const FileStamp now = stamp_of(path);
  if (!is_certainly_same(known.stamp, now)) known = {path, now, sha256_of_file(path)};
  return known.sha256;
}

MeshStatus status_of(ExitCode code) {
  switch (code) {
    case ExitCode::kDone:
      return MeshStatus::kOk;
    case ExitCode::kUsage:  // options that do not suit this mesh
    case ExitCode::kInput:
      return MeshStatus::kInvalid;
    case ExitCode::kOutput:
      return MeshStatus::kUnwritable;
    case ExitCode::kLimit:
      return MeshStatus::kMemory;
    default:
      return MeshStatus::kCrashed;
  }
}

// Among many meshes an error about the options is one about this mesh.
JobResult result_of(const Failure& failure, const std::string& mesh) {
  JobResult result;
  result.row.status = status_of(failure.code);
  result.row.exit = static_cast<int>(failure.code);
  const bool is_about_options = failure.code == ExitCode::kUsage && failure.message.starts_with("--");
  result.row.message = (is_about_options ? mesh + ": " : "") + failure.message;
  return result;
}

JobResult evaluate(const LatticeCommand& command, const RunLimits& limits) {
  Thumbnail thumbnail;
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  const std::string grid_before = grid ? hash_of_grid(grid->path) : "";
  const RunReport report =
      run_lattice(command, limits,
                  [&thumbnail](const PlacedLattice& lattice, const LatticeBlock& block,
                               std::span<const double> values) { thumbnail.add(lattice.grid, block, values); });
  JobResult result = result_of(report, thumbnail.bmp());
  if (!grid) return result;
  // Unknown where it changed meanwhile.
  const std::string hash = hash_of_grid(grid->path) == grid_before ? grid_before : "";
  result.companions.push_back({.path = grid->path, .sha256 = hash});
  return result;
}

// Points make no picture.
JobResult evaluate(const PointsCommand& command, const RunLimits& limits) {
  return result_of(run_points(command, limits), "");
}

// Of a mesh that could not be evaluated: what tells later whether it is still the same. A pipe would have to be waited
// for. Empty where the file is no longer the one that was asked about.
std::string hash_of(const std::string& mesh, const FileStamp& stamp) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(mesh, error)) return "";
  try {
    const std::string hash = sha256_of_file(mesh);
    return stamp_of(mesh) == stamp ? hash : "";
  } catch (const InputError&) {
    return "";
  }
}

const MeshOptions& mesh_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const MeshOptions& { return one.mesh; }, command);
}

// What else its evaluation depends on.
std::vector<std::string> further_inputs(const MeshCommand& command) {
  const MeshOptions& mesh = mesh_of(command);
  std::vector<std::string> paths;
  try {
    paths = files_referred_to(mesh.path, mesh.reading);
  } catch (const std::exception&) {  // it fails whatever there is beside it
  }
  const auto* const lattice = std::get_if<LatticeCommand>(&command);
  const auto* const grid = lattice ? std::get_if<GridReference>(&lattice->lattice) : nullptr;
  if (grid) paths.push_back(grid->path);
  return paths;
}

JobResult answer_to(const InputsRequest& request) {
  JobResult result;
  result.row.status = MeshStatus::kInvalid;  // it has no figures
  result.row.sha256 = hash_of(mesh_of(request.command).path, request.stamp);
  if (result.row.sha256.empty()) return result;
  for (const std::string& path : further_inputs(request.command)) {
    result.companions.push_back(file_as_at(path, request.started));
  }
  return result;
}

template <typename OneCommand>
JobResult perform(const OneCommand& command) {
  reset_peak_memory();
  try {
    return within_limits(command.run, command.mesh.path, [&command](const RunLimits& limits) {
      refuse_to_replace_input(files_written(command), inputs_of(command));
      return evaluate(command, limits);
    });
  } catch (...) {
    return result_of(current_failure(), command.mesh.path);
  }
}

JobResult answer_to(const Message& message) {
  if (const std::optional<InputsRequest> request = inputs_request_from(message)) return answer_to(*request);
  return std::visit([](const auto& one) { return perform(one); }, mesh_command_from(message));
}

}  // namespace

ExitCode run_worker() {
  leave_signals_to_supervisor();
  std::set_terminate(end_without_memory);
  Connection supervisor(take_socket());
  while (const std::optional<Message> message = supervisor.receive()) {
    if (!supervisor.send(to_message(answer_to(*message)))) break;
    return_unused_memory(peak_memory());
  }
  return ExitCode::kDone;
}

}  // namespace raycone
