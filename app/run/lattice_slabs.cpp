#include "app/run/lattice_slabs.h"

#include "app/process/memory_limit.h"
#include "app/process/stopwatch.h"
#include "app/run/field_run.h"
#include "app/samples/disk_space.h"
#include "app/samples/lattice_checks.h"
#include "io/vdb/read_vdb.h"

namespace raycone {
namespace {

// Loading the module for VDB maps stacks and other memory without touching it.
std::unique_ptr<LatticeWriter> make_writer(const LatticeCommand& command, OutputFile& output,
                                           const PlacedLattice& lattice, const OutputDescription& description,
                                           const RunLimits& limits) {
  constexpr double kMappedByModule = 160.0 * 1024 * 1024;
  const bool loads = command.encoding.format == FieldFormat::kVdb && !vdb_module_is_loaded();
  if (loads) cap_memory(limits.memory(), kMappedByModule);
  std::unique_ptr<LatticeWriter> writer = make_lattice_writer(command.encoding.format, output, lattice, description);
  if (loads) cap_memory(limits.memory());
  return writer;
}

bool may_take_blocks(const LatticeCommand& command, const PlacedLattice& lattice) {
  return may_use_blocks(command.field) && lattice.along_axes() && cuts_off(command.field.band, lattice.grid);
}

SlabKind slab_kind(const RunReport& report) { return {report.exterior_edges > 0, !report.lattice->along_axes()}; }

double writer_memory(const LatticeCommand& command, const RunReport& report) {
  const OutputDescription description = description_of(report, command.field, command.encoding);
  return writer_memory(report.lattice->grid, command.encoding.format, description, slab_kind(report));
}

// Sides and distances alone have no values that a far field could be for. Distances at points are prepared before,
// others when the first slab is evaluated.
double working_memory(const LatticeCommand& command, const RunReport& report) {
  const FieldOptions& field = command.field;
  const bool as_points = !world_order(*report.lattice).has_value();
  const bool has_values = field.has(Field::kWinding) || field.has(Field::kDensity) || field.diagnostics;
  const double of_values =
      has_values ? raycone::working_memory(slab_kind(report), static_cast<double>(report.samples)) : 0.0;
  return of_values + (as_points ? 0.0 : memory_of_distances(report.faces, field));
}

// What is needed beside what is in memory, as far as it is known before there is a writer. All of it for VDB, whose
// module must be counted before it is loaded.
double memory_to_begin(const LatticeCommand& command, const RunReport& report) {
  constexpr double kTouchedByModule = 36.0 * 1024 * 1024;  // measured: 34 MB
  const double of_writer = writer_memory(command, report) + working_memory(command, report);
  if (command.encoding.format != FieldFormat::kVdb) return of_writer;
  const Lattice& grid = report.lattice->grid;
  SlabKind kind = slab_kind(report);
  kind.blocks = may_take_blocks(command, *report.lattice);
  const LatticeBlock smallest = slab_from(grid, 2, kVdbSlabAlignment, grid.index_min[2], 1);
  const double module = vdb_module_is_loaded() ? 0.0 : kTouchedByModule;  // as in a worker that is used again
  return module + of_writer + slab_memory(smallest, command.field, kind);
}

}  // namespace

bool takes_blocks(const LatticeCommand& command, const LatticeWriter& writer, const PlacedLattice& lattice) {
  return writer.takes_blocks() && may_take_blocks(command, lattice);
}

void check_slab_memory(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
                       const RunLimits& limits) {
  const LatticeBlock smallest = Slabs(report.lattice->grid, writer, 1).first();
  SlabKind kind = slab_kind(report);
  kind.blocks = takes_blocks(command, writer, *report.lattice);
  const double bytes =
      writer_memory(command, report) + slab_memory(smallest, command.field, kind) + working_memory(command, report);
  check_memory(report.mesh, bytes, limits.memory());
}

// To load what writes VDB may take longer than all the rest.
std::unique_ptr<LatticeWriter> open_lattice_writer(const LatticeCommand& command, MeshRun& run) {
  RunReport& report = run.report;
  const FieldFormat format = command.encoding.format;
  const OutputDescription description = description_of(report, command.field, command.encoding);
  check_digits(report.output, *report.lattice, command.field, format, description);
  check_memory(report.mesh, memory_to_begin(command, report), run.limits().memory());
  run.output.reserve(least_lattice_file(format, description, report.samples));
  std::unique_ptr<LatticeWriter> writer = timed(report.seconds.write, [&] {
    return make_writer(command, run.output, *report.lattice, description, run.limits());
  });
  check_slab_memory(command, *writer, report, run.limits());
  return writer;
}

Slabs slabs_of(const LatticeCommand& command, const LatticeWriter& writer, const RunReport& report,
               const RunLimits& limits) {
  const double taken = memory_in_use() + writer_memory(command, report) + working_memory(command, report);
  const double left = static_cast<double>(limits.memory()) - taken;
  return {report.lattice->grid, writer, slab_samples(command.field, slab_kind(report), left)};
}

}  // namespace raycone
