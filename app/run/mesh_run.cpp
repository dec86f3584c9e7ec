#include "app/run/mesh_run.h"

#include <cstddef>
#include <utility>

#include "app/input/mesh_input.h"
#include "app/process/memory_limit.h"
#include "app/report/depfile.h"
#include "app/report/json.h"

namespace raycone {

MeshRun::MeshRun(const MeshOptions& mesh, const OutputFiles& written, const RunOptions& options,
                 const std::vector<std::string>& inputs, const RunLimits& limits)
    : output(written.path, written.existing, &files),
      mesh_(mesh),
      written_(written),
      options_(options),
      limits_(limits),
      total_(std::in_place, report.seconds.total) {
  report.mesh = mesh.path;
  report.output = written.path;
  report.command = options.words;
  report.options = options.options;
  report.threads = limits.threads();
  if (written.report) report_file_ = std::make_unique<OutputFile>(*written.report, written.existing, &files);
  if (written.depfile) {
    (void)depfile_text(written.path, inputs);  // throws before the work
    depfile_ = std::make_unique<OutputFile>(*written.depfile, written.existing, &files);
  }
}

TriangleMesh MeshRun::load_mesh(const std::vector<WrittenFile>& written) {
  TransformedMesh transformed = timed(report.seconds.read, [&] { return read_mesh_file(mesh_, limits_); });
  MeshFile& file = transformed.file;
  report.transform = transformed.transform;
  report.sha256 = file.sha256;
  report.unit = file.parsed.unit;
  report.companions = file.companions;
  report.files_read.push_back(report.mesh);
  for (const FileRead& companion : file.companions) report.files_read.push_back(companion.path);
  report.vertices = file.parsed.mesh.vertices.size();
  report.faces = file.parsed.mesh.triangles.size();
  report.warnings = std::move(file.parsed.warnings);
  check_files_read(written);
  return prepare(std::move(file.parsed.mesh));
}

void MeshRun::check_files_read(const std::vector<WrittenFile>& written) const {
  refuse_to_replace_input(written, report.files_read);
  if (depfile_) (void)depfile_text(written_.path, report.files_read);
}

TriangleMesh MeshRun::prepare(TriangleMesh as_read) {
  MeshToEvaluate input =
      timed(report.seconds.prepare, [&] { return mesh_to_evaluate(std::move(as_read), mesh_, report.warnings); });
  report.orientation = input.orientation;
  edges_ = std::move(input.edges);
  report.exterior_edges = edges_.size();
  places_ = std::move(input.places);
  return std::move(input.mesh);
}

void MeshRun::print(const std::string& file, const std::vector<Warning>& warnings, const RunOptions& options) {
  const auto write = [&] { raycone::print_warnings(warnings, options, file); };
  if (progress_) {
    progress_->interrupt(write);
  } else {
    write();
  }
}

void MeshRun::print_warnings() {
  const auto first = report.warnings.begin() + static_cast<std::ptrdiff_t>(printed_);
  print(report.mesh, {first, report.warnings.end()}, options_);
  printed_ = report.warnings.size();
}

void MeshRun::warn(const Warning& warning) {
  report.warnings.push_back(warning);
  print_warnings();
}

void MeshRun::warn_about(const std::string& mesh, const std::vector<Warning>& warnings) {
  print(mesh, warnings, options_);
  for (const Warning& warning : warnings) {
    report.warnings.push_back({warning.name, (report.meshes.size() > 1 ? mesh + ": " : "") + warning.text});
  }
  printed_ = report.warnings.size();
}

void MeshRun::warn_of_points(const std::string& points, const std::vector<Warning>& warnings) {
  RunOptions options = options_;
  options.strict = false;
  print(points, warnings, options);
  for (const Warning& warning : warnings) report.warnings.push_back({warning.name, points + ": " + warning.text});
  printed_ = report.warnings.size();
}

std::atomic<std::uint64_t>* MeshRun::start_progress(std::optional<std::uint64_t> total) {
  return progress_.emplace(progress_is_shown(options_.progress_mode(), written_.path), total).done();
}

void MeshRun::set_stage(const char* stage) {
  if (progress_) progress_->set_stage(stage);
}

RunReport MeshRun::finish() {
  if (progress_) progress_->stop();
  total_.reset();
  report.peak_memory_bytes = peak_memory();
  if (report_file_) write_all(*report_file_, to_json(report));
  if (depfile_) write_all(*depfile_, depfile_text(report.output, report.files_read));
  report.placed = files.commit();
  return std::move(report);
}

}  // namespace raycone
