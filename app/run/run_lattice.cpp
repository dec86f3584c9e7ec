#include "app/run/run_lattice.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/process/limits.h"
#include "app/process/stopwatch.h"
#include "app/process/usage_error.h"
#include "app/run/disk_space.h"
#include "app/run/field_run.h"
#include "app/run/grid_reader.h"
#include "app/run/lattice_choice.h"
#include "app/run/make_surface.h"
#include "app/run/mesh_run.h"
#include "app/run/mesh_warnings.h"
#include "app/run/slabs.h"
#include "app/run/written_files.h"
#include "io/fields/field_writer.h"
#include "io/fields/read_image_lattice.h"
#include "io/fields/read_npz_lattice.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

// A level set has one voxel size.
void check_cubic(const char* field, const Vec3& spacing) {
  constexpr double kRounding = 1e-12;  // of sides divided by counts
  const auto [least, most] = std::minmax({spacing.x, spacing.y, spacing.z});
  if (most - least <= kRounding * most) return;
  char message[160];
  std::snprintf(message, sizeof message,
                "--field %s: voxels of %g x %g x %g, expected cubic ones (--resolution N, --voxel-size H)", field,
                spacing.x, spacing.y, spacing.z);
  throw UsageError(message);
}

Lattice lattice_of_grid(const GridReference& grid) {
  if (is_image(grid.path)) return read_image_lattice(grid.path);
  return is_npz(grid.path) ? read_npz_lattice(grid.path) : read_grid_lattice(grid.path, grid.name);
}

Lattice lattice_for(const LatticeCommand& command, const TriangleMesh& mesh, std::vector<Warning>& warnings) {
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  const Lattice lattice = grid
                              ? lattice_of_grid(*grid)
                              : choose_lattice(bounding_box(mesh), std::get<LatticeRequest>(command.lattice), warnings);
  if (command.field.has(Field::kDistance)) check_cubic("sdf", lattice.spacing);
  if (command.field.has(Field::kSolid)) check_cubic("solid", lattice.spacing);
  return lattice;
}

// A band in voxels that all samples are in: as wide as the box of mesh and lattice is long, from corner to corner.
double band_of_all(const Box& mesh_box, const Lattice& lattice) {
  Vec3 sides;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = lattice.coordinate(axis, lattice.index_min[static_cast<std::size_t>(axis)]);
    const double last = lattice.coordinate(axis, lattice.index_max(axis));
    sides[axis] = std::max(mesh_box.upper[axis], last) - std::min(mesh_box.lower[axis], first);
  }
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr double kMore = 1 + 1e-9;  // so that rounding cuts nothing off
  const double width = std::min(std::hypot(sides.x, sides.y, sides.z), kLargest / 2) * kMore;
  return std::min(width / lattice.spacing.x, kLargest);
}

// The slabs of a lattice, one after the other.
class Slabs {
 public:
  Slabs(const Lattice& lattice, const LatticeWriter& writer, std::int64_t samples)
      : lattice_(lattice), axis_(writer.slab_axis()), alignment_(writer.slab_alignment()), samples_(samples) {}

  [[nodiscard]] LatticeBlock first() const { return from(lattice_.index_min[static_cast<std::size_t>(axis_)]); }
  [[nodiscard]] LatticeBlock behind(const LatticeBlock& slab) const {
    const auto axis = static_cast<std::size_t>(axis_);
    return from(slab.first[axis] + slab.counts[axis]);
  }

 private:
  [[nodiscard]] LatticeBlock from(std::int64_t index) const {
    return slab_from(lattice_, axis_, alignment_, index, samples_);
  }

  const Lattice& lattice_;
  int axis_;
  std::int64_t alignment_, samples_;
};

// Loading the module for VDB maps stacks and other memory without touching it.
std::unique_ptr<LatticeWriter> make_writer(const LatticeCommand& command, OutputFile& output, const Lattice& lattice,
                                           const OutputDescription& description, const RunLimits& limits) {
  constexpr double kMappedByModule = 160.0 * 1024 * 1024;
  constexpr double kTouchedByModule = 36.0 * 1024 * 1024;  // measured: 34 MB
  const bool loads = command.encoding.format == FieldFormat::kVdb;
  if (loads) check_memory(command.mesh.path, kTouchedByModule, limits.memory());
  if (loads) cap_memory(limits.memory(), kMappedByModule);
  std::unique_ptr<LatticeWriter> writer = make_lattice_writer(command.encoding.format, output, lattice, description);
  if (loads) cap_memory(limits.memory());
  return writer;
}

// Refuses lattices that cannot fit, before any work on them.
std::unique_ptr<LatticeWriter> open_writer(const LatticeCommand& command, MeshRun& run) {
  const RunReport& report = run.report;
  const RunLimits& limits = run.limits();
  const Lattice& lattice = *report.lattice;
  const FieldFormat format = command.encoding.format;
  const OutputDescription description = description_of(report, command.field, command.encoding);
  const double of_writer = writer_memory(lattice, format, description);
  check_memory(report.mesh, of_writer, limits.memory());
  run.output.reserve(least_lattice_file(format, description, report.samples));
  std::unique_ptr<LatticeWriter> writer = make_writer(command, run.output, lattice, description, limits);
  const LatticeBlock smallest = Slabs(lattice, *writer, 1).first();
  check_memory(report.mesh, of_writer + slab_memory(smallest, command.field, report.exterior_edges > 0),
               limits.memory());
  return writer;
}

// Slabs as memory allows.
Slabs slabs_of(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
               const RunLimits& limits) {
  const OutputDescription description = description_of(report, command.field, command.encoding);
  const double of_writer = writer_memory(*report.lattice, command.encoding.format, description);
  const double left = static_cast<double>(limits.memory()) - memory_in_use() - of_writer;
  return {*report.lattice, writer, slab_samples(command.field, report.exterior_edges > 0, left)};
}

void evaluate_lattice(FieldRun& fields, const Slabs& slabs, LatticeWriter& writer, const SlabObserver& observe,
                      MeshRun& run) {
  const Lattice& lattice = *run.report.lattice;
  std::atomic<std::uint64_t>* const done = run.start_progress(run.report.samples);
  for (LatticeBlock slab = slabs.first(); slab.size() > 0; slab = slabs.behind(slab)) {
    fields.evaluate(lattice, slab, done);
    if (observe) observe(lattice, slab, fields.winding_numbers());
    timed(run.report.seconds.write, [&] { writer.write(slab, fields.values()); });
  }
}

// The surface that `raycone surface` would make.
TriangleMesh solid_of(MeshRun& run, const TriangleMesh& mesh, const Lattice& lattice, const Rule& rule) {
  return timed(run.report.seconds.prepare, [&] {
    const WindingNumberEvaluator evaluator(mesh);
    MadeSurface made =
        make_surface(run.report.mesh, mesh, evaluator, lattice, SurfaceOptions{rule}, run.limits().memory());
    run.report.surface = made.report;
    return std::move(made.surface.mesh);
  });
}

}  // namespace

RunReport run_lattice(const LatticeCommand& asked, const RunLimits& limits, const SlabObserver& observe) {
  LatticeCommand command = asked;
  MeshRun run(command.mesh, command.output, command.run, limits);
  RunReport& report = run.report;
  TriangleMesh mesh = run.load_mesh(files_written(command));
  report.lattice = lattice_for(command, mesh, report.warnings);
  if (const auto* const grid = std::get_if<GridReference>(&command.lattice)) report.files_read.push_back(grid->path);
  report.samples = sample_count(*report.lattice);
  const bool solid = command.field.has(Field::kSolid);
  // The lattice of the surface that solid distances are to: outside nodes around do not change it.
  const Lattice around = solid ? with_layers(*report.lattice, 1) : *report.lattice;
  if (std::isinf(command.field.band)) command.field.band = band_of_all(bounding_box(mesh), around);
  run.print_warnings();

  const TriangleMesh original = solid ? mesh : TriangleMesh{};
  const bool may_be_empty = !should_have_inside(bounding_box(mesh), *report.lattice);
  FieldRun fields(run, std::move(mesh), command.field, static_cast<double>(report.samples));
  const std::unique_ptr<LatticeWriter> writer = open_writer(command, run);
  if (solid) fields.set_solid(solid_of(run, original, around, command.field.rule));
  evaluate_lattice(fields, slabs_of(command, *writer, report, limits), *writer, observe, run);
  if (fields.found_nothing_inside() && !may_be_empty) run.warn(nothing_inside(command.field.rule));
  fields.finish(command.field.band * report.lattice->spacing.x);
  timed(report.seconds.write, [&] { writer->finish({report.tally.degenerate, report.tally.on_surface}); });
  return run.finish();
}

}  // namespace raycone
