// What runs have in common that evaluate fields and write them with writers of formats.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "app/fields/field_evaluator.h"
#include "app/fields/fields.h"
#include "app/fields/label_volume.h"
#include "app/fields/sample_draw.h"
#include "app/options/field_options.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/run/mesh_run.h"
#include "core/data/placed_lattice.h"
#include "core/data/triangle_mesh.h"
#include "io/fields/field_writer.h"

namespace raycone {

class FieldRun {
 public:
  // Prepares what the fields need, but for what only points need. `run` and `field` must outlive this. `samples`: how
  // many there will be, about. `points`: Accuracy::points.
  FieldRun(MeshRun& run, TriangleMesh mesh, const FieldOptions& field, double samples, double points = 0.0);

  // Sets the closed surface that solid distances are to. Call it before evaluate() where they are wanted.
  void set_solid(TriangleMesh surface);

  // Builds the search structures that points need.
  void prepare_points();

  // From here on lattices have blocks() in place of values(). Precondition: may_use_blocks(), and lattices along the
  // axes.
  void use_blocks() { samples_.use_blocks(); }
  [[nodiscard]] bool uses_blocks() { return samples_.distance_blocks() != nullptr; }
  [[nodiscard]] SignedBlocks blocks() { return {*samples_.distance_blocks(), samples_.sides()}; }

  // Evaluates a block, or some finite points; values() are theirs then. Samples to be verified are kept. `done`, where
  // given, grows by one per sample.
  void evaluate(const PlacedLattice& lattice, const LatticeBlock& block, std::atomic<std::uint64_t>* done);
  void evaluate(std::span<const Vec3> points, std::atomic<std::uint64_t>* done);
  [[nodiscard]] std::span<const FieldValues> values() const { return samples_.fields(); }
  // Labels of the last samples, for the caller to set where they are wanted.
  [[nodiscard]] std::span<std::int32_t> labels() { return samples_.labels(); }
  // Sets the labels of the block that was evaluated last. Where nothing else is asked for, shown() is 1 where there is
  // a label, else 0.
  void take_labels(const LabelVolume& volume, const LatticeBlock& block);
  [[nodiscard]] std::vector<double> shown() const { return samples_.shown(); }

  // Whether a rule was asked for of the mesh as a whole, and held for no sample.
  [[nodiscard]] bool found_nothing_inside() const { return tells_inside() && !found_inside_; }

  // Tells the report what evaluating took and, where asked for, verifies. `band_width`: the distance at which values
  // are cut off, world units. Throws VerificationError.
  void finish(double band_width);

 private:
  void warn_of_difference(double difference);
  [[nodiscard]] bool tells_inside() const { return field_.has(Field::kInside) || field_.has_distance(); }
  void look_for_inside();
  void look_for_largest_bound();

  MeshRun& run_;
  const FieldOptions& field_;
  TriangleMesh original_;  // to verify; empty where that is not asked for
  TriangleMesh solid_;     // likewise
  FieldEvaluator evaluator_;
  FieldSamples samples_;
  SampleDraw draw_;
  bool found_inside_ = false;
  bool of_lattice_ = false;
  double largest_bound_ = 0.0;  // of diagnostics
};

// The least bytes that signed distances to so many triangles take, for their search structure; 0 where none are wanted.
[[nodiscard]] double memory_of_distances(std::uint64_t triangles, const FieldOptions& field);

// Refuses search structures that do not fit within `limits`, before any work: those of the report's mesh for so many
// points. Throws LimitError.
void check_points_memory(const RunReport& report, const FieldOptions& field, double points, const RunLimits& limits);

// The same for the evaluators of so many parts, which labels of points keep all at once.
void check_parts_memory(const MeshOptions& options, std::size_t parts, const RunLimits& limits);

// The same for what verification keeps of a run of so many samples, as far as their number is known.
void check_verify_memory(const MeshOptions& options, const FieldOptions& field, double samples,
                         const RunLimits& limits);

// What the output will hold and say about itself. `report` is complete as far as mesh, edges and lattice go.
[[nodiscard]] OutputDescription description_of(const RunReport& report, const FieldOptions& field,
                                               const FieldEncoding& encoding);

}  // namespace raycone
