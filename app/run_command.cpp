// From a command to its results, reports and summary.
#include "app/run_command.h"

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "app/batch/report_page.h"
#include "app/batch/run_batch.h"
#include "app/report/info.h"
#include "app/report/json.h"
#include "app/run/run_lattice.h"
#include "app/run/run_points.h"
#include "app/run/run_slice.h"
#include "app/run/run_steps.h"
#include "core/mesh/mesh_statistics.h"
#include "core/mesh/weld.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

void print(const std::string& text) {
  OutputFile standard_output("-");
  standard_output.write(text.data(), text.size());
  standard_output.commit();
}

ExitCode run(const LatticeCommand& command, const RunLimits& limits) {
  std::vector<std::string> inputs{command.mesh.path};
  if (const auto* const grid = std::get_if<GridReference>(&command.lattice)) inputs.push_back(grid->path);
  refuse_to_replace_input(files_written(command.output), inputs);
  const SideFiles side_files = open_side_files(command.output);
  publish(run_lattice(command, limits), command.run, side_files);
  return ExitCode::kDone;
}

ExitCode run(const PointsCommand& command, const RunLimits& limits) {
  std::vector<std::string> inputs{command.mesh.path};
  if (!command.sample) inputs.push_back(command.points);
  refuse_to_replace_input(files_written(command.output), inputs);
  const SideFiles side_files = open_side_files(command.output);
  publish(run_points(command, limits), command.run, side_files);
  return ExitCode::kDone;
}

ExitCode run(const SliceCommand& command, const RunLimits& limits) {
  refuse_to_replace_input(files_written(command), {command.mesh.path});
  const SideFiles side_files = open_side_files(command.output);
  publish(run_slice(command, limits), command.run, side_files);
  return ExitCode::kDone;
}

ExitCode run(const InfoCommand& command, const RunLimits& limits) {
  const std::vector<WrittenFile> written{{"-", "output"}};
  refuse_to_replace_input(written, {command.mesh.path});
  const MeshFile file = read(command.mesh, limits);
  for (const FileRead& companion : file.companions) refuse_to_replace_input(written, {companion.path});
  warn(file.parsed.warnings, command.run, command.mesh.path);
  const TriangleMesh mesh = weld(file.parsed.mesh, command.mesh.weld);
  MeshInfo info;
  info.mesh = command.mesh.path;
  info.faces = file.parsed.mesh.triangles.size();
  info.vertices = file.parsed.mesh.vertices.size();
  info.welded_vertices = mesh.vertices.size();
  info.skipped_faces = file.parsed.skipped_faces;
  info.bounds = bounding_box(mesh);
  info.statistics = mesh_statistics(mesh);
  print(command.json ? to_json(info) : info_text(info, limits.threads()));
  return ExitCode::kDone;
}

template <typename MeshCommand>
ExitCode dispatch(const MeshCommand& command) {
  return within_limits(command.run, command.mesh.path,
                       [&command](const RunLimits& limits) { return run(command, limits); });
}

ExitCode dispatch(const BatchCommand& command) { return run_batch(command); }

ExitCode dispatch(const ReportCommand& command) {
  write_report_page(command);
  return ExitCode::kDone;
}

ExitCode dispatch(const PrintCommand& command) {
  print(command.text);
  return ExitCode::kDone;
}

}  // namespace

ExitCode run(const Command& command) {
  return std::visit([](const auto& one) { return dispatch(one); }, command);
}

}  // namespace raycone
