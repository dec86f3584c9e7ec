#include "app/run/run_steps.h"

#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

#include "app/process/limits.h"
#include "app/process/signals.h"
#include "app/process/usage_error.h"
#include "app/report/depfile.h"
#include "app/report/json.h"
#include "core/mesh/polygons.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"

namespace raycone {
namespace {

std::string name_of_output(const std::string& path) { return path == "-" ? "standard output" : path; }

// Each thread may have an arena, and none uses what is free in another one's.
void share_arenas(std::uint64_t memory) {
  constexpr std::uint64_t kPerArena = std::uint64_t{64} << 20;
  constexpr std::uint64_t kMostArenas = 64;
  mallopt(M_ARENA_MAX, static_cast<int>(std::clamp<std::uint64_t>(memory / kPerArena, 1, kMostArenas)));
}

// TBB starts as many workers as there are CPUs, now or later, however few are allowed to work, and ends the process
// where it cannot. So all are started before anything is limited; the memory cap then takes their stacks for untouched.
int with_all_workers(int threads) {
  prime_threads();
  return threads;
}

}  // namespace

RunLimits::RunLimits(const RunOptions& options, const std::string& mesh)
    : threads_(options.threads ? *options.threads : default_threads()),
      memory_(options.memory_limit ? *options.memory_limit : available_memory()),
      thread_limit_(with_all_workers(threads_)) {
  if (options.timeout) start_timeout(*options.timeout, mesh);
  share_arenas(memory_);
  prime_threads();  // of more threads than CPUs, the rest
  check_memory(mesh, 0.0, memory_);
  cap_memory(memory_);
}

void rethrow_as_limit(const std::string& mesh, const RunLimits* limits) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    const std::string limit = limits ? ", the limit is " + readable_bytes(static_cast<double>(limits->memory())) : "";
    throw LimitError(mesh + ": out of memory" + limit);
  } catch (const ThreadsUnavailable& error) {
    throw LimitError(mesh + ": " + error.what());
  }
}

std::vector<WrittenFile> files_written(const OutputFiles& output) {
  std::vector<WrittenFile> written{{output.path, "output"}};
  if (output.report) written.push_back({*output.report, "report"});
  if (output.depfile) written.push_back({*output.depfile, "depfile"});
  return written;
}

std::vector<WrittenFile> files_written(const SliceCommand& command) {
  std::vector<WrittenFile> written = files_written(command.output);
  if (command.values) written.push_back({*command.values, "values"});
  return written;
}

void refuse_to_replace_input(const std::vector<WrittenFile>& written, const std::vector<std::string>& inputs) {
  std::vector<std::optional<FileIdentity>> read;
  for (const std::string& input : inputs) read.push_back(identity_of_input(input));
  for (std::size_t n = 0; n < written.size(); ++n) {
    const auto& [path, role] = written[n];
    const std::optional<FileIdentity> identity = identity_of_output(path);
    if (identity && std::ranges::count(read, identity) > 0) {
      throw UsageError(name_of_output(path) + ": is input and " + role);
    }
    for (std::size_t before = 0; before < n; ++before) {
      const auto& [other, other_role] = written[before];
      if (path == other || (identity && identity == identity_of_output(other))) {
        throw UsageError(name_of_output(path) + ": is " + other_role + " and " + role);
      }
    }
  }
}

void prepare_engine(const WindingNumberEvaluator& evaluator, const FieldOptions& field, const RunLimits& limits) {
  constexpr double kMappedByEmbree = 192.0 * 1024 * 1024;
  if (field.engine != RayEngine::kEmbree) return;
  cap_memory(limits.memory(), kMappedByEmbree);
  evaluator.prepare_points();
  cap_memory(limits.memory());
}

SideFiles open_side_files(const OutputFiles& output) {
  SideFiles files;
  if (output.report) files.report = std::make_unique<OutputFile>(*output.report, output.no_clobber);
  if (output.depfile) files.depfile = std::make_unique<OutputFile>(*output.depfile, output.no_clobber);
  return files;
}

MeshFile read(const MeshOptions& mesh, const RunLimits& limits) {
  std::error_code error;  // what has no size, such as a pipe, is not checked
  const std::uintmax_t size = std::filesystem::file_size(mesh.path, error);
  if (!error && mesh.path != "-") check_memory(mesh.path, static_cast<double>(size), limits.memory());
  MeshFile file = read_mesh(mesh.path, mesh.reading);
  const std::vector<PolygonFan> polygons = std::move(file.parsed.polygons);
  if (const std::uint64_t bad = cut_concave_polygons(file.parsed.mesh, polygons)) {
    const std::string what = bad == 1 ? " polygon that crosses itself" : " polygons that cross themselves";
    file.parsed.warnings.push_back("bad-polygons: " + std::to_string(bad) + what +
                                   ", seen along the area vector, fanned from the first corner");
  }
  return file;
}

RunReport report_on(const MeshOptions& mesh, const OutputFiles& output, const RunLimits& limits) {
  RunReport report;
  report.mesh = mesh.path;
  report.output = output.path;
  report.threads = limits.threads();
  return report;
}

void describe(const MeshFile& file, RunReport& report) {
  report.sha256 = file.sha256;
  report.companions = file.companions;
  report.files_read.push_back(report.mesh);
  for (const FileRead& companion : file.companions) report.files_read.push_back(companion.path);
  report.vertices = file.parsed.mesh.vertices.size();
  report.faces = file.parsed.mesh.triangles.size();
}

OutputDescription description_of(const RunReport& report, const FieldOptions& field, const OutputOptions& output) {
  OutputDescription description;
  description.fields = describe_fields(field, report.lattice ? field.band * report.lattice->spacing.x : 0.0);
  if (output.grid_name) description.fields.front().grid = *output.grid_name;
  description.mesh = std::filesystem::path(report.mesh).filename().string();
  description.mesh_sha256 = report.sha256;
  description.faces = report.faces;
  description.exterior_edges = report.exterior_edges;
  description.double_precision = output.double_precision;
  description.half_precision = output.half_precision;
  return description;
}

void warn(const std::vector<std::string>& warnings, const RunOptions& options, const std::string& mesh) {
  for (const std::string& warning : warnings) {
    if (options.strict) throw InputError(mesh + ": " + warning + " (an error because of --strict)");
    if (!options.quiet) print_message("warning: " + mesh + ": " + warning);
  }
}

TriangleMesh mesh_to_verify(const TriangleMesh& mesh, const FieldOptions& field) {
  return field.verify > 0 ? mesh : TriangleMesh{};
}

void publish(const RunReport& report, const RunOptions& options, const SideFiles& files) {
  const auto write = [](OutputFile& file, const std::string& text) {
    file.write(text.data(), text.size());
    file.commit();
  };
  if (files.report) write(*files.report, to_json(report));
  if (files.depfile) write(*files.depfile, depfile_text(report.output, report.files_read));
  if (!options.quiet) print_message(summary_line(report));
}

}  // namespace raycone
