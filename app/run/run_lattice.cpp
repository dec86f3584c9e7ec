#include "app/run/run_lattice.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "app/fields/make_surface.h"
#include "app/input/grid_lattice.h"
#include "app/input/mesh_warnings.h"
#include "app/input/written_files.h"
#include "app/process/memory_limit.h"
#include "app/process/stopwatch.h"
#include "app/report/json.h"
#include "app/run/field_run.h"
#include "app/run/labels.h"
#include "app/run/lattice_slabs.h"
#include "app/run/mesh_run.h"
#include "app/samples/lattice_checks.h"
#include "app/samples/lattice_choice.h"
#include "io/fields/field_writer.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"

namespace raycone {
namespace {

PlacedLattice lattice_for(const LatticeCommand& command, const Box& box, std::vector<Warning>& warnings) {
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  const auto chosen = [&] { return choose_lattice(box, std::get<LatticeRequest>(command.lattice), warnings); };
  const PlacedLattice lattice = grid ? lattice_of_grid(*grid) : PlacedLattice(choose_for(command.mesh.path, chosen));
  check_axes(lattice, command.field, grid ? "another --like" : "--resolution N, --voxel-size H");
  return lattice;
}

// A band (voxels) that holds all samples: as wide as the diagonal of the box around mesh and lattice is long.
double band_of_all(const Box& mesh_box, const PlacedLattice& lattice) {
  const Box all = hull(mesh_box, box_of(lattice));
  const Vec3 sides = all.upper - all.lower;
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr double kMore = 1 + 1e-9;  // so that rounding cuts nothing off
  const double width = std::min(std::hypot(sides.x, sides.y, sides.z), kLargest / 2) * kMore;
  return std::min(width / lattice.grid.spacing.x, kLargest);
}

// The mesh as a whole; where nothing is asked about it, one without triangles.
struct LoadedMesh {
  std::optional<LabelledParts> parts;  // where they are asked for
  TriangleMesh mesh;
  Box box;
};

void load(const LatticeCommand& command, MeshRun& run, LoadedMesh& loaded) {
  const FieldOptions& field = command.field;
  if (!field.has(Field::kLabel)) {
    loaded.mesh = run.load_mesh(files_written(command));
    loaded.box = bounding_box(loaded.mesh);
    return;
  }
  const WholeMesh whole = field.labels_only() ? WholeMesh::kUnused : WholeMesh::kEvaluated;
  loaded.parts.emplace(run, command.mesh, field, files_written(command), whole);
  if (!field.labels_only()) loaded.mesh = run.prepare(loaded.parts->whole());
  loaded.box = loaded.parts->box();
}

// The lattice of the surface that solid distances are to. It is that of `raycone surface`: how faces are merged, and
// points kept off nodes, depends on the whole lattice.
Lattice solid_lattice(const LatticeCommand& command, const PlacedLattice& lattice) {
  const auto layered = [&] { return with_layers(world_order(lattice)->lattice, layers_around(command.lattice)); };
  return choose_for(command.mesh.path, layered);
}

// The surface that `raycone surface` would make.
TriangleMesh solid_of(const LatticeCommand& command, MeshRun& run, const TriangleMesh& mesh) {
  return timed(run.report.seconds.prepare, [&] {
    const Lattice lattice = solid_lattice(command, *run.report.lattice);
    SurfaceOptions options{command.field.rule};
    options.at_stage = [&run](const char* stage) { run.set_stage(stage); };
    const std::vector<ExteriorEdge> edges = exterior_edges(mesh);
    const MeshToClose input{.mesh = mesh,
                            .edges = edges,
                            .name = run.report.mesh,
                            .orient = command.mesh.orient,
                            .like_grid = std::holds_alternative<GridReference>(command.lattice)};
    MadeSurface made =
        make_surface(input, lattice, options, run.limits().memory(), run.start_progress(sample_count(lattice)));
    run.report.surface = made.report;
    // How its faces are merged does not concern distances.
    for (const Warning& warning : made.warnings) {
      if (warning.name == "thin-parts") run.warn(warning);
    }
    return std::move(made.surface.mesh);
  });
}

// Sets the report's lattice and its samples and, with --band all, the band of `command`.
void choose(LatticeCommand& command, const Box& mesh_box, MeshRun& run) {
  RunReport& report = run.report;
  report.lattice = lattice_for(command, mesh_box, report.warnings);
  const auto* const grid = std::get_if<GridReference>(&command.lattice);
  if (grid) report.files_read.push_back(grid->path);
  report.samples =
      choose_for(grid ? grid->path : command.mesh.path, [&] { return sample_count(report.lattice->grid); });
  if (!std::isinf(command.field.band)) return;
  const bool solid = command.field.has(Field::kSolid);
  command.field.band =
      band_of_all(mesh_box, solid ? PlacedLattice(solid_lattice(command, *report.lattice)) : *report.lattice);
}

// A lattice that is ready to be evaluated and written, slab by slab.
struct LatticeWork {
  std::unique_ptr<LatticeWriter> writer;
  std::optional<LabelVolume> labels;  // where they are asked for
  std::optional<FieldRun> fields;
};

// `command` must outlive the work.
void prepare(LatticeCommand& command, LoadedMesh& loaded, MeshRun& run, LatticeWork& work) {
  const PlacedLattice& lattice = *run.report.lattice;
  const bool as_points = !world_order(lattice).has_value();
  const double points = as_points ? static_cast<double>(run.report.samples) : 0.0;
  check_points_memory(run.report, command.field, points, run.limits());
  check_verify_memory(command.mesh, command.field, static_cast<double>(run.report.samples), run.limits());
  if (loaded.parts) {
    check_memory(run.report.mesh, LabelVolume::bytes(lattice.grid, loaded.parts->size()), run.limits().memory());
  }
  work.writer = open_lattice_writer(command, run);
  if (loaded.parts) work.labels = label_lattice(*loaded.parts, lattice, command.field, run);
  if (command.field.labels_only()) command.field.verify = 0;  // done
  const bool solid = command.field.has(Field::kSolid);
  const TriangleMesh original = solid ? loaded.mesh : TriangleMesh{};
  work.fields.emplace(run, std::move(loaded.mesh), command.field, static_cast<double>(run.report.samples));
  if (as_points) work.fields->prepare_points();
  check_slab_memory(command, *work.writer, run.report, run.limits());  // beside what is prepared now
  if (solid) work.fields->set_solid(solid_of(command, run, original));
  if (takes_blocks(command, *work.writer, lattice)) work.fields->use_blocks();
}

void evaluate_lattice(const LatticeCommand& command, LatticeWork& work, const SlabObserver& observe, MeshRun& run) {
  const PlacedLattice& lattice = *run.report.lattice;
  FieldRun& fields = *work.fields;
  LatticeWriter& writer = *work.writer;
  const Slabs slabs = slabs_of(command, writer, run.report, run.limits());
  std::atomic<std::uint64_t>* const done = run.start_progress(run.report.samples);
  for (LatticeBlock slab = slabs.first(); slab.size() > 0; slab = slabs.behind(slab)) {
    fields.evaluate(lattice, slab, done);
    if (work.labels) fields.take_labels(*work.labels, slab);
    if (observe) observe(lattice, slab, fields.shown());
    timed(run.report.seconds.write,
          [&] { fields.uses_blocks() ? writer.write_blocks(fields.blocks()) : writer.write(slab, fields.values()); });
  }
}

}  // namespace

RunReport run_lattice(const LatticeCommand& asked, const RunLimits& limits, const SlabObserver& observe) {
  LatticeCommand command = asked;
  MeshRun run(command.mesh, command.output, command.run, inputs_of(command), limits);
  const std::unique_ptr<OutputFile> names = open_label_names(command, run.files);
  RunReport& report = run.report;
  LoadedMesh loaded;
  load(command, run, loaded);
  choose(command, loaded.box, run);
  run.print_warnings();

  LatticeWork work;
  prepare(command, loaded, run, work);
  evaluate_lattice(command, work, observe, run);
  const bool may_be_empty = !should_have_inside(loaded.box, *report.lattice);
  if (work.fields->found_nothing_inside() && !may_be_empty) {
    run.warn(nothing_inside(command.field.rule, command.mesh.orient, loaded.box, *report.lattice));
  }
  work.fields->finish(command.field.band * report.lattice->grid.spacing.x);
  timed(report.seconds.write, [&] {
    work.writer->finish({report.tally.degenerate, report.tally.on_surface, report.exterior_edges});
  });
  if (names) write_all(*names, label_table_json(report));
  return run.finish();
}

}  // namespace raycone
