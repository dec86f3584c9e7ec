#include "app/run_steps.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "app/json.h"
#include "app/limits.h"
#include "app/signals.h"
#include "app/usage_error.h"
#include "io/file_error.h"

namespace raycone {
namespace {

bool are_one_regular_file(const std::string& a, const std::string& b) {
  std::error_code error;  // a file that does not exist is no other
  return a != "-" && b != "-" && std::filesystem::is_regular_file(a, error) && std::filesystem::equivalent(a, b, error);
}

}  // namespace

RunLimits::RunLimits(const RunOptions& options, const std::string& mesh)
    : threads_(options.threads ? *options.threads : default_threads()),
      memory_(options.memory_limit ? *options.memory_limit : available_memory()),
      thread_limit_(threads_) {
  if (options.timeout) start_timeout(*options.timeout, mesh);
  if (options.memory_limit) cap_memory(memory_, threads_);
}

void refuse_to_replace_input(const OutputOptions& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (are_one_regular_file(output.path, input)) throw UsageError(output.path + ": is input and output");
    if (!output.report) continue;
    if (are_one_regular_file(*output.report, input)) throw UsageError(*output.report + ": is input and report");
  }
  if (output.report && are_one_regular_file(*output.report, output.path)) {
    throw UsageError(output.path + ": is output and report");
  }
}

std::unique_ptr<OutputFile> open_report(const OutputOptions& output) {
  return output.report ? std::make_unique<OutputFile>(*output.report, output.no_clobber) : nullptr;
}

MeshFile read(const MeshOptions& mesh, const RunLimits& limits) {
  std::error_code error;  // what has no size, such as a pipe, is not checked
  const std::uintmax_t size = std::filesystem::file_size(mesh.path, error);
  if (!error && mesh.path != "-") check_memory(mesh.path, static_cast<double>(size), limits.memory());
  return read_mesh(mesh.path, mesh.reading);
}

RunReport report_on(const MeshOptions& mesh, const OutputOptions& output, const RunLimits& limits) {
  RunReport report;
  report.mesh = mesh.path;
  report.output = output.path;
  report.threads = limits.threads();
  return report;
}

void describe(const MeshFile& file, RunReport& report) {
  report.sha256 = file.sha256;
  report.files_read = file.files_read;
  report.vertices = file.parsed.mesh.vertices.size();
  report.faces = file.parsed.mesh.triangles.size();
}

OutputDescription description_of(const RunReport& report, const FieldOptions& field, const OutputOptions& output) {
  OutputDescription description;
  description.fields = describe_fields(field, report.lattice ? field.band * report.lattice->spacing.x : 0.0);
  description.mesh = std::filesystem::path(report.mesh).filename().string();
  description.mesh_sha256 = report.sha256;
  description.faces = report.faces;
  description.exterior_edges = report.exterior_edges;
  description.double_precision = output.double_precision;
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

std::string out_of_memory(const std::string& mesh, const RunOptions& options) {
  const std::optional<std::uint64_t> limit = options.memory_limit;
  return mesh + ": out of memory" + (limit ? ", the limit is " + readable_bytes(static_cast<double>(*limit)) : "");
}

void publish(const RunReport& report, const RunOptions& options, OutputFile* report_file) {
  if (report_file) {
    const std::string document = to_json(report);
    report_file->write(document.data(), document.size());
    report_file->commit();
  }
  if (!options.quiet) print_message(summary_line(report));
}

}  // namespace raycone
