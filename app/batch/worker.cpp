#include "app/batch/worker.h"

#include <fcntl.h>
#include <malloc.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
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
#include "app/batch/file_stamp.h"
#include "app/batch/job_result.h"
#include "app/batch/thumbnail.h"
#include "app/input/mesh_input.h"
#include "app/input/run_limits.h"
#include "app/input/written_files.h"
#include "app/options/batch_command.h"
#include "app/process/memory_limit.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "app/process/usage_error.h"
#include "app/report/run_report.h"
#include "app/run/run_lattice.h"
#include "app/run/run_points.h"
#include "core/machine/threads.h"
#include "io/files/base64.h"
#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/output_file.h"
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

MeshFigures figures_of(const RunReport& report) {
  const Seconds& seconds = report.seconds;
  return {.faces = report.faces,
          .exterior_edges = report.exterior_edges,
          .samples = report.samples,
          .degenerate = report.tally.degenerate,
          .on_surface = report.tally.on_surface,
          .read_s = seconds.read,
          .prepare_s = seconds.prepare,
          .evaluate_s = seconds.evaluate,
          .write_s = seconds.write,
          .peak_memory_bytes = report.peak_memory_bytes,
          .flipped_faces = report.orientation.flipped_faces,
          .dropped_duplicates = report.orientation.dropped_duplicates,
          .patches = report.orientation.patches};
}

// Where a buffer of the mesh lies, wherever both are.
std::string relative_to_mesh(const std::string& path, const std::string& mesh) {
  const std::filesystem::path directory = directory_of(mesh);
  return std::filesystem::path(path).lexically_relative(directory.lexically_normal()).string();
}

// Each of `written` as it was put in its place.
std::vector<OutputStamp> stamps_of(const std::vector<WrittenFile>& written, const std::vector<PlacedFile>& placed) {
  std::vector<OutputStamp> stamps;
  for (const WrittenFile& file : written) {
    const auto same = std::ranges::find(placed, file.path, &PlacedFile::name);
    stamps.push_back(same == placed.end() ? OutputStamp{} : OutputStamp{same->size, same->modified});
  }
  return stamps;
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
  for (const FileRead& file : report.companions) {
    result.buffers.push_back({.path = relative_to_mesh(file.path, report.mesh), .sha256 = file.sha256});
  }
  return result;
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
  const std::string grid_before = grid ? hash_of_file(grid->path) : "";  // read by another process, job after job
  const RunReport report =
      run_lattice(command, limits,
                  [&thumbnail](const PlacedLattice& lattice, const LatticeBlock& block,
                               std::span<const double> values) { thumbnail.add(lattice.grid, block, values); });
  JobResult result = result_of(report, thumbnail.bmp());
  result.written = stamps_of(files_written(command), report.placed);
  if (grid && hash_of_file(grid->path) == grid_before) result.grid = grid_before;  // else it changed meanwhile
  return result;
}

// Points make no picture.
JobResult evaluate(const PointsCommand& command, const RunLimits& limits) {
  const RunReport report = run_points(command, limits);
  JobResult result = result_of(report, "");
  result.written = stamps_of(files_written(command), report.placed);
  return result;
}

// Of the exception being handled. The machine and the output are no fault of the mesh's: those are tried again.
JobResult failure_of(const std::string& mesh) {
  JobResult result = result_of(current_failure(), mesh);
  try {
    throw;
  } catch (const UnavailableError&) {
    result.row.status = MeshStatus::kCrashed;
  } catch (const ReplacesFileError&) {
    result.row.status = MeshStatus::kUnwritable;
  } catch (const UnreadableError&) {
    result.knows_inputs = false;
  } catch (const StrictWarning& warning) {
    result.row.warnings = warning.name();
  } catch (...) {
  }
  return result;
}

// The mesh has to be the same before it is read and when all is done: links and directories on its path may change.
template <typename OneCommand>
JobResult perform(const OneCommand& command) {
  reset_peak_memory();
  const std::string& mesh = command.mesh.path;
  const FileStamp before = stamp_of(mesh);
  JobResult result;
  try {
    result = within_limits(command.run, mesh, [&command](const RunLimits& limits) {
      refuse_to_replace_input(files_written(command), inputs_of(command));
      return evaluate(command, limits);
    });
  } catch (...) {
    result = failure_of(mesh);
  }
  result.stamp = before;
  result.stamp.recent = before.recent || stamp_of(mesh) != before;
  return result;
}

const MeshOptions& mesh_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const MeshOptions& { return one.mesh; }, command);
}

const RunOptions& run_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const RunOptions& { return one.run; }, command);
}

// The buffers of a mesh that could not be evaluated, as they were at `time`; nothing where they cannot be told.
std::optional<std::vector<StampedFile>> buffers_of(const MeshOptions& mesh, const RunOptions& run, std::int64_t time) {
  std::vector<StampedFile> buffers;
  try {
    const auto files = [&mesh](const RunLimits&) { return files_referred_to(mesh.path, mesh.reading); };
    for (const std::string& path : within_limits(run, mesh.path, files)) {
      buffers.push_back(file_as_at(path, time));
      buffers.back().path = relative_to_mesh(path, mesh.path);
    }
    return buffers;
  } catch (const UnreadableError&) {
    return std::nullopt;
  } catch (const InputError&) {
    return buffers;  // it fails whatever there is beside it
  } catch (const LimitError&) {
    return may_refer_to_files(mesh.path, mesh.reading) ? std::nullopt : std::optional(buffers);
  }
}

// Of the inputs of a command that failed: what tells later whether they are still the same. Of what is no file, such as
// a pipe, that is the stamp alone.
JobResult inputs_of(const InputsRequest& request) {
  JobResult result;
  result.row.status = MeshStatus::kInvalid;  // it has no figures
  const MeshOptions& mesh = mesh_of(request.command);
  const std::string content = hash_of_file(mesh.path);
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(mesh.path, error);
  std::optional<std::vector<StampedFile>> buffers{std::in_place};
  if (is_file) buffers = buffers_of(mesh, run_of(request.command), request.started);
  const bool is_same = (content != kNoFile || !is_file) && stamp_of(mesh.path) == request.stamp;
  result.knows_inputs = is_same && buffers;
  if (!result.knows_inputs) return result;
  if (is_file) result.row.sha256 = content;
  result.buffers = std::move(*buffers);
  if (const GridReference* const grid = grid_of(request.command)) {
    result.grid = file_as_at(grid->path, request.started).sha256;
  }
  return result;
}

JobResult answer_to(const Message& message) {
  if (const std::optional<InputsRequest> request = inputs_request_from(message)) return inputs_of(*request);
  return std::visit([](const auto& one) { return perform(one); }, mesh_command_from(message));
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
