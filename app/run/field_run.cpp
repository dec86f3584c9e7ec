#include "app/run/field_run.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/fields/verify.h"
#include "app/input/mesh_warnings.h"
#include "app/process/memory_limit.h"
#include "app/process/stopwatch.h"
#include "app/report/json.h"
#include "app/text/plain_text.h"

namespace raycone {
namespace {

// Where Embree is asked for, prepares it, which maps much memory and touches little.
void prepare_engine(const WindingNumberEvaluator& evaluator, const FieldOptions& field, const RunLimits& limits) {
  constexpr double kMappedByEmbree = 192.0 * 1024 * 1024;
  if (field.engine != RayEngine::kEmbree) return;
  cap_memory(limits.memory(), kMappedByEmbree);
  evaluator.prepare_points();
  cap_memory(limits.memory());
}

}  // namespace

FieldRun::FieldRun(MeshRun& run, TriangleMesh mesh, const FieldOptions& field, double samples, double points)
    : run_(run),
      field_(field),
      original_(field.verify > 0 ? mesh : TriangleMesh{}),
      evaluator_(timed(run.report.seconds.prepare,
                       [&] {
                         const std::vector<ExteriorEdge> edges = run.take_edges();
                         return FieldEvaluator(std::move(mesh), field, &edges, samples, points);
                       })),
      samples_(field),
      draw_(field.verify) {
  timed(run.report.seconds.prepare, [&] { prepare_engine(evaluator_.winding_number(), field, run.limits()); });
  if (field.labels_only()) return;
  if (const auto warning = tolerance_not_kept(field.tolerance, evaluator_.expected_error())) run.warn(*warning);
}

void FieldRun::set_solid(TriangleMesh surface) {
  timed(run_.report.seconds.prepare, [&] { evaluator_.set_solid(surface); });
  if (field_.verify > 0) solid_ = std::move(surface);
}

void FieldRun::prepare_points() {
  timed(run_.report.seconds.prepare, [&] { evaluator_.prepare_points(); });
}

void FieldRun::evaluate(const PlacedLattice& lattice, const LatticeBlock& block, std::atomic<std::uint64_t>* done) {
  of_lattice_ = true;
  run_.report.tally +=
      timed(run_.report.seconds.evaluate, [&] { return evaluator_.evaluate(lattice, block, samples_, done); });
  look_for_inside();
  look_for_largest_bound();
  if (uses_blocks()) {
    const SignedBlocks signed_blocks = blocks();
    draw_.offer(lattice, block, {}, &signed_blocks);
  } else {
    draw_.offer(lattice, block, samples_.numbers());
  }
}

void FieldRun::evaluate(std::span<const Vec3> points, std::atomic<std::uint64_t>* done) {
  run_.report.tally += timed(run_.report.seconds.evaluate, [&] { return evaluator_.evaluate(points, samples_, done); });
  look_for_inside();
  look_for_largest_bound();
  draw_.offer(points, samples_.numbers());
}

void FieldRun::take_labels(const LabelVolume& volume, const LatticeBlock& block) {
  volume.copy(block, samples_.labels());
  if (!field_.labels_only()) return;
  std::ranges::transform(samples_.labels(), samples_.sides().begin(),
                         [](std::int32_t label) { return static_cast<std::uint8_t>(label != 0); });
}

void FieldRun::look_for_largest_bound() {
  const Diagnostics* diagnostics = samples_.diagnostics();
  if (!diagnostics || diagnostics->error_bound.empty()) return;
  largest_bound_ = std::max(largest_bound_, std::ranges::max(diagnostics->error_bound));
}

void FieldRun::look_for_inside() {
  if (!tells_inside() || found_inside_) return;
  found_inside_ = std::ranges::any_of(samples_.sides(), [](std::uint8_t side) { return side != 0; });
}

void FieldRun::finish(double band_width) {
  const WindingNumberEvaluator& evaluator = evaluator_.winding_number();
  run_.report.terms += evaluator.terms();
  const double bound = field_.diagnostics ? largest_bound_ : evaluator_.expected_error();
  run_.report.largest_error_bound = std::max(run_.report.largest_error_bound, bound);
  if (field_.verify == 0) return;
  const Verification found = timed(run_.report.seconds.verify, [&] {
    // Lattices and points may have different engines, each within the tolerance.
    const bool may_differ = of_lattice_ && evaluator.exterior_edges() > 0 && field_.tolerance > 0.0;
    const double most = std::max(evaluator.expected_error(), evaluator.error_of_agreeing_roundings());
    const double within = may_differ ? 2 * most : 0.0;
    return verify(run_.report.mesh, {original_, &solid_}, {evaluator_, field_, band_width, within}, draw_.samples());
  });
  run_.report.add_verification(found);
  warn_of_difference(found.largest_difference);
}

// Of what sums round beyond what they are expected to.
void FieldRun::warn_of_difference(double difference) {
  const WindingNumberEvaluator& evaluator = evaluator_.winding_number();
  if (evaluator.exterior_edges() == 0 || difference <= evaluator.expected_error()) return;
  run_.report.largest_error_bound = std::max(run_.report.largest_error_bound, difference);
  if (const auto warning = tolerance_not_kept(field_.tolerance, difference)) run_.warn(*warning);
}

double memory_of_distances(std::uint64_t triangles, const FieldOptions& field) {
  constexpr double kPerTriangle = 192.0;  // less than any measured, so that nothing that fits is refused: 212 to 230
  return field.has(Field::kDistance) ? kPerTriangle * static_cast<double>(triangles) : 0.0;
}

void check_points_memory(const RunReport& report, const FieldOptions& field, double points, const RunLimits& limits) {
  constexpr double kPerTriangle = 112.0;  // of a grid, edge-on to the rays: its filters and footprints; 250 are common
  const auto faces = static_cast<double>(report.faces);
  const bool has_grid = field.engine == RayEngine::kScan && grid_pays_for_points(points, faces);
  const double of_grid = has_grid ? kPerTriangle * faces : 0.0;
  check_memory(report.mesh, of_grid + memory_of_distances(report.faces, field), limits.memory());
}

void check_parts_memory(const MeshOptions& options, std::size_t parts, const RunLimits& limits) {
  constexpr double kPerPart = 4096.0;  // less than any measured: 4.2 to 4.8 kB
  check_memory(options.path, kPerPart * static_cast<double>(parts), limits.memory());
}

void check_verify_memory(const MeshOptions& options, const FieldOptions& field, double samples,
                         const RunLimits& limits) {
  constexpr double kPerSample = 600.0, kPerLabel = 300.0;  // likewise: 630 to 650, and 310
  const double each = field.labels_only() ? kPerLabel : kPerSample;
  check_memory(options.path, each * std::min(static_cast<double>(field.verify), samples), limits.memory());
}

OutputDescription description_of(const RunReport& report, const FieldOptions& field, const FieldEncoding& encoding) {
  OutputDescription description;
  description.fields = describe_fields(field, report.lattice ? field.band * report.lattice->grid.spacing.x : 0.0);
  if (encoding.grid_name) description.fields.front().grid = *encoding.grid_name;
  description.mesh = valid_utf8(std::filesystem::path(report.mesh).filename().string());
  description.mesh_sha256 = report.sha256;
  description.transform = report.transform;
  description.faces = report.faces;
  description.precision = encoding.precision;
  description.packs_flags = encoding.pack_bits;
  description.compress = encoding.compress;
  for (const std::string& option : report.options) description.options.push_back(valid_utf8(option));
  std::vector<std::string> names;
  for (const FieldDescription& described : description.fields) names.push_back(described.name);
  description.metadata = provenance_json(report, names, field.has_rule() ? name_of(field.rule) : "");
  if (field.has(Field::kLabel)) {
    for (const PartReport& part : report.parts) description.labels.push_back(valid_utf8(part.name));
    description.label_names = label_names_json(report);
  }
  return description;
}

}  // namespace raycone
