#include "app/run_command.h"

#include <cstddef>
#include <string>
#include <variant>

#include "app/batch/report_page.h"
#include "app/batch/run_batch.h"
#include "app/input/mesh_list.h"
#include "app/input/run_limits.h"
#include "app/input/written_files.h"
#include "app/process/messages.h"
#include "app/run/run_info.h"
#include "app/run/run_lattice.h"
#include "app/run/run_points.h"
#include "app/run/run_slice.h"
#include "app/run/run_surface.h"
#include "io/files/counted.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

void print(const std::string& text) {
  OutputFile standard_output("-");
  write_all(standard_output, text);
}

RunReport evaluate(const LatticeCommand& command, const RunLimits& limits) { return run_lattice(command, limits); }
RunReport evaluate(const PointsCommand& command, const RunLimits& limits) { return run_points(command, limits); }
RunReport evaluate(const SliceCommand& command, const RunLimits& limits) { return run_slice(command, limits); }
RunReport evaluate(const SurfaceCommand& command, const RunLimits& limits) { return run_surface(command, limits); }

// With the meshes that lists name.
LatticeCommand expanded(LatticeCommand command) {
  if (command.field.has(Field::kLabel)) command.mesh = with_listed_meshes(command.mesh);
  return command;
}
PointsCommand expanded(PointsCommand command) {
  if (command.field.has(Field::kLabel)) command.mesh = with_listed_meshes(command.mesh, command.points);
  return command;
}
SliceCommand expanded(SliceCommand command) {
  if (command.field.has(Field::kLabel)) command.mesh = with_listed_meshes(command.mesh);
  return command;
}
const SurfaceCommand& expanded(const SurfaceCommand& command) { return command; }

// From a mesh to files about it: lattice, points, slice, surface.
template <typename EvaluatingCommand>
ExitCode dispatch(const EvaluatingCommand& given) {
  within_limits(given.run, given.mesh.path, [&given](const RunLimits& limits) {
    const auto& command = expanded(given);
    refuse_terminal(files_written(command));
    refuse_to_replace_input(files_written(command), inputs_of(command));
    const RunReport report = evaluate(command, limits);
    if (!command.run.quiet) print_message(summary_line(report));
  });
  return ExitCode::kDone;
}

ExitCode dispatch(const InfoCommand& command) {
  const std::size_t meshes = command.meshes.size();
  const std::string name = meshes == 1 ? command.meshes.front().path : std::to_string(meshes) + " meshes";
  return within_limits(command.run, name, [&command](const RunLimits& limits) { return run_info(command, limits); });
}

ExitCode dispatch(const BatchCommand& command) { return run_batch(command); }

ExitCode dispatch(const ReportCommand& command) {
  within_limits(command.run, command.directory, [&command](const RunLimits&) {
    const std::size_t meshes = write_report_page(command);
    const std::string place = command.output == "-" ? "standard output" : command.output;
    if (!command.run.quiet) print_message(command.directory + ": " + counted(meshes, "mesh") + " -> " + place);
  });
  return ExitCode::kDone;
}

ExitCode dispatch(const PrintCommand& command) {
  print(command.text);
  return ExitCode::kDone;
}

}  // namespace

ExitCode run_command(const Command& command) {
  return std::visit([](const auto& one) { return dispatch(one); }, command);
}

}  // namespace raycone
