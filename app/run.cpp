// From a command to its results, reports and summary.
#include "app/run.h"

#include <memory>
#include <new>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/info.h"
#include "app/json.h"
#include "app/limits.h"
#include "app/run_lattice.h"
#include "app/run_points.h"
#include "app/run_steps.h"
#include "core/mesh_statistics.h"
#include "core/weld.h"
#include "io/file_error.h"
#include "io/output_file.h"

namespace raycone {
namespace {

void print(const std::string& text) {
  OutputFile standard_output("-");
  standard_output.write(text.data(), text.size());
  standard_output.commit();
}

void run(const LatticeCommand& command) {
  const RunLimits limits(command.run, command.mesh.path);
  refuse_to_replace_input(command.output, {command.mesh.path});
  const std::unique_ptr<OutputFile> report_file = open_report(command.output);
  publish(run_lattice(command, limits), command.run, report_file.get());
}

void run(const PointsCommand& command) {
  const RunLimits limits(command.run, command.mesh.path);
  refuse_to_replace_input(command.output, {command.mesh.path, command.points});
  const std::unique_ptr<OutputFile> report_file = open_report(command.output);
  publish(run_points(command, limits), command.run, report_file.get());
}

void run(const InfoCommand& command) {
  const RunLimits limits(command.run, command.mesh.path);
  const MeshFile file = read(command.mesh, limits);
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
}

// Failed allocations are a limit of the run, so the message names it.
template <typename MeshCommand>
void run_within_limits(const MeshCommand& command) {
  try {
    run(command);
  } catch (const std::bad_alloc&) {
    const std::optional<std::uint64_t> limit = command.run.memory_limit;
    throw LimitError(command.mesh.path + ": out of memory" +
                     (limit ? ", the limit is " + readable_bytes(static_cast<double>(*limit)) : ""));
  }
}

void run_within_limits(const PrintCommand& command) { print(command.text); }

}  // namespace

void run(const Command& command) {
  std::visit([](const auto& one) { run_within_limits(one); }, command);
}

}  // namespace raycone
