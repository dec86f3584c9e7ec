#include "app/batch/perform_job.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/batch/thumbnail.h"
#include "app/input/mesh_input.h"
#include "app/input/run_limits.h"
#include "app/input/written_files.h"
#include "app/process/messages.h"
#include "app/process/usage_error.h"
#include "app/report/run_report.h"
#include "app/run/run_lattice.h"
#include "app/run/run_points.h"
#include "io/files/base64.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

// The peak of memory counts from here on: each job has its own.
void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << '5'; }

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

}  // namespace

JobResult perform_job(const MeshCommand& command) {
  return std::visit([](const auto& one) { return perform(one); }, command);
}

}  // namespace raycone
