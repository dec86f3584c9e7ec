#include "app/run/run_surface.h"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

#include "app/fields/make_surface.h"
#include "app/input/grid_lattice.h"
#include "app/input/written_files.h"
#include "app/process/stopwatch.h"
#include "app/run/mesh_run.h"
#include "app/samples/lattice_choice.h"
#include "io/files/file_error.h"
#include "io/mesh/write_surface.h"

namespace raycone {
namespace {

// The layers of samples around what is asked for, with those that --thicken needs.
Layers layers_of(const SurfaceCommand& command, const Vec3& spacing) {
  constexpr double kMost = 1e6;
  Layers layers = layers_around(command.lattice);
  for (std::size_t axis = 0; axis < layers.size(); ++axis) {
    const double more = std::ceil(command.thickness / spacing[static_cast<int>(axis)]);
    if (!(more <= kMost)) throw LimitError(command.mesh.path + ": --thicken is more than a million voxels");
    layers[axis] += static_cast<std::int64_t>(more);
  }
  return layers;
}

// The lattice that is asked for, with layers_of() around it.
Lattice surface_lattice(const SurfaceCommand& command, const TriangleMesh& mesh, std::vector<Warning>& warnings) {
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  const auto chosen = [&] {
    return choose_lattice(bounding_box(mesh), std::get<LatticeRequest>(command.lattice), warnings);
  };
  const Lattice lattice = grid ? world_lattice_of_grid(*grid, "surface") : choose_for(command.mesh.path, chosen);
  const Layers layers = layers_of(command, lattice.spacing);
  return choose_for(grid ? grid->path : command.mesh.path, [&] { return with_layers(lattice, layers); });
}

}  // namespace

RunReport run_surface(const SurfaceCommand& command, const RunLimits& limits) {
  MeshRun run(command.mesh, command.output, command.run, inputs_of(command), limits);
  RunReport& report = run.report;
  TriangleMesh mesh = run.load_mesh(files_written(command));
  const Lattice lattice = surface_lattice(command, mesh, report.warnings);
  report.lattice = lattice;
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  if (grid) report.files_read.push_back(grid->path);
  report.samples = choose_for(grid ? grid->path : command.mesh.path, [&] { return sample_count(lattice); });
  run.print_warnings();

  const std::vector<ExteriorEdge> edges = run.take_edges();
  SurfaceOptions options{command.rule, command.thickness, command.merge_planes, command.simplify,
                         vertex_precision(command.format)};
  options.at_stage = [&run](const char* stage) { run.set_stage(stage); };
  std::atomic<std::uint64_t>* const done = run.start_progress(report.samples);
  const MeshToClose input{
      .mesh = mesh, .edges = edges, .name = report.mesh, .orient = command.mesh.orient, .like_grid = grid != nullptr};
  MadeSurface made =
      timed(report.seconds.evaluate, [&] { return make_surface(input, lattice, options, limits.memory(), done); });
  report.surface = made.report;
  report.tally = made.tally;
  report.terms = made.terms;
  for (const Warning& warning : made.warnings) run.warn(warning);
  for (std::int32_t& source : made.surface.sources) {
    if (source != kHole) source = static_cast<std::int32_t>(run.place_of(static_cast<std::uint32_t>(source)));
  }
  run.set_stage("writing");
  timed(report.seconds.write,
        [&] { write_surface(run.output, command.format, made.surface.mesh, made.surface.sources); });
  return run.finish();
}

}  // namespace raycone
