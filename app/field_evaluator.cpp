#include "app/field_evaluator.h"

#include <utility>

namespace raycone {

FieldEvaluator::FieldEvaluator(TriangleMesh mesh, const FieldOptions& options)
    : band_(options.band),
      distance_(options.has(Field::kDistance) ? std::optional<DistanceEvaluator>(mesh) : std::nullopt),
      winding_number_(std::move(mesh), options.engine, options.simd) {}

void FieldEvaluator::prepare_points() const {
  winding_number_.prepare_points();
  if (distance_) distance_->prepare_points();
}

Tally FieldEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, FieldSamples& samples,
                               std::atomic<std::uint64_t>* done) const {
  samples.resize(static_cast<std::size_t>(block.size()));
  const Tally tally = winding_number_.evaluate(lattice, block, samples.winding_numbers(), done, samples.diagnostics());
  if (distance_) distance_->evaluate(lattice, block, band_ * lattice.spacing.x, samples.distances());
  samples.derive();
  return tally;
}

Tally FieldEvaluator::evaluate(std::span<const Vec3> points, FieldSamples& samples,
                               std::atomic<std::uint64_t>* done) const {
  samples.resize(points.size());
  const Tally tally = winding_number_.evaluate(points, samples.winding_numbers(), done, samples.diagnostics());
  if (distance_) distance_->evaluate(points, samples.distances());
  samples.derive();
  return tally;
}

}  // namespace raycone
