// Straight lines: output opened, mesh read, welded, evaluator built, samples evaluated and written.
#include "app/run/run_lattice.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/process/limits.h"
#include "app/process/progress.h"
#include "app/process/stopwatch.h"
#include "app/process/usage_error.h"
#include "app/run/disk_space.h"
#include "app/run/field_evaluator.h"
#include "app/run/fields.h"
#include "app/run/grid_reader.h"
#include "app/run/lattice_choice.h"
#include "app/run/slabs.h"
#include "app/run/verify.h"
#include "core/mesh/weld.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

// A level set has one voxel size.
void check_cubic(const Vec3& spacing) {
  constexpr double kRounding = 1e-12;  // of sides divided by counts
  const auto [least, most] = std::minmax({spacing.x, spacing.y, spacing.z});
  if (most - least <= kRounding * most) return;
  char message[160];
  std::snprintf(message, sizeof message,
                "--field sdf: voxels of %g x %g x %g, expected cubic ones (--resolution N, --voxel-size H)", spacing.x,
                spacing.y, spacing.z);
  throw UsageError(message);
}

Lattice lattice_for(const LatticeCommand& command, const TriangleMesh& mesh, std::vector<std::string>& warnings) {
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  const Lattice lattice = grid
                              ? read_grid_lattice(grid->path, grid->name)
                              : choose_lattice(bounding_box(mesh), std::get<LatticeRequest>(command.lattice), warnings);
  if (command.field.has(Field::kDistance)) check_cubic(lattice.spacing);
  return lattice;
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
  const bool loads = command.output.format == FieldFormat::kVdb;
  if (loads) check_memory(command.mesh.path, kTouchedByModule, limits.memory());
  if (loads) cap_memory(limits.memory(), kMappedByModule);
  std::unique_ptr<LatticeWriter> writer = make_lattice_writer(command.output.format, output, lattice, description);
  if (loads) cap_memory(limits.memory());
  return writer;
}

// Refuses lattices that cannot fit, before any work on them.
std::unique_ptr<LatticeWriter> open_writer(const LatticeCommand& command, OutputFile& output, const RunReport& report,
                                           const RunLimits& limits) {
  const Lattice& lattice = *report.lattice;
  const FieldFormat format = command.output.format;
  const OutputDescription description = description_of(report, command.field, command.output);
  const double of_writer = writer_memory(lattice, format, description);
  check_memory(report.mesh, of_writer, limits.memory());
  output.reserve(least_lattice_file(format, description, report.samples));
  std::unique_ptr<LatticeWriter> writer = make_writer(command, output, lattice, description, limits);
  const LatticeBlock smallest = Slabs(lattice, *writer, 1).first();
  check_memory(report.mesh, of_writer + slab_memory(smallest, command.field), limits.memory());
  return writer;
}

// Slabs as memory allows.
Slabs slabs_of(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
               const RunLimits& limits) {
  const OutputDescription description = description_of(report, command.field, command.output);
  const double of_writer = writer_memory(*report.lattice, command.output.format, description);
  const double left = static_cast<double>(limits.memory()) - memory_in_use() - of_writer;
  return {*report.lattice, writer, slab_samples(command.field, left)};
}

void evaluate_lattice(const FieldEvaluator& evaluator, const Slabs& slabs, LatticeWriter& writer, FieldSamples& samples,
                      SampleDraw& draw, const SlabObserver& observe, Progress& progress, RunReport& report) {
  const Lattice& lattice = *report.lattice;
  for (LatticeBlock slab = slabs.first(); slab.size() > 0; slab = slabs.behind(slab)) {
    report.tally +=
        timed(report.seconds.evaluate, [&] { return evaluator.evaluate(lattice, slab, samples, progress.done()); });
    draw.offer(lattice, slab, samples.numbers());
    if (observe) observe(lattice, slab, samples.winding_numbers());
    timed(report.seconds.write, [&] { writer.write(slab, samples.fields()); });
  }
}

}  // namespace

RunReport run_lattice(const LatticeCommand& command, const RunLimits& limits, const SlabObserver& observe) {
  RunReport report = report_on(command.mesh, command.output, limits);
  auto total = std::make_optional<Stopwatch>(report.seconds.total);
  OutputFile output(command.output.path, command.output.no_clobber);

  MeshFile file = timed(report.seconds.read, [&] { return read(command.mesh, limits); });
  describe(file, report);
  refuse_to_replace_input(files_written(command.output), report.files_read);
  TriangleMesh mesh =
      timed(report.seconds.prepare, [&] { return weld(std::move(file.parsed.mesh), command.mesh.weld); });
  report.warnings = std::move(file.parsed.warnings);
  report.lattice = lattice_for(command, mesh, report.warnings);
  if (const auto* const grid = std::get_if<GridReference>(&command.lattice)) report.files_read.push_back(grid->path);
  report.samples = sample_count(*report.lattice);
  warn(report.warnings, command.run, command.mesh.path);

  const TriangleMesh original = mesh_to_verify(mesh, command.field);
  const auto evaluator = timed(report.seconds.prepare, [&] { return FieldEvaluator(std::move(mesh), command.field); });
  prepare_engine(evaluator.winding_number(), command.field, limits);
  report.exterior_edges = evaluator.winding_number().exterior_edges();
  const std::unique_ptr<LatticeWriter> writer = open_writer(command, output, report, limits);

  Progress progress(progress_is_shown(command.run.progress, command.run.quiet, command.output.path), report.samples);
  FieldSamples samples(command.field);
  SampleDraw draw(command.field.verify);
  const Slabs slabs = slabs_of(command, *writer, report, limits);
  evaluate_lattice(evaluator, slabs, *writer, samples, draw, observe, progress, report);
  if (command.field.verify > 0) {
    report.verification = verify(report.mesh, original, evaluator, command.field,
                                 command.field.band * report.lattice->spacing.x, draw.samples());
  }
  timed(report.seconds.write, [&] { writer->finish({report.tally.degenerate, report.tally.on_surface}); });
  progress.stop();
  total.reset();
  report.peak_memory_bytes = peak_memory();
  return report;
}

}  // namespace raycone
