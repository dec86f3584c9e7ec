#include "app/fields/field_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

std::optional<GradientEvaluator> gradient_for(const TriangleMesh& mesh, const FieldOptions& options,
                                              const std::vector<ExteriorEdge>* edges) {
  if (!options.has(Field::kGradient)) return std::nullopt;
  return GradientEvaluator(mesh, edges ? *edges : exterior_edges(mesh), options.simd);
}

}  // namespace

double tolerance_of_evaluation(const FieldOptions& options) {
  if (!(options.tolerance > 0.0) || !options.rule_only()) return options.tolerance;
  return tolerance_for_sides(options.rule);
}

FieldEvaluator::FieldEvaluator(TriangleMesh mesh, const FieldOptions& options, const std::vector<ExteriorEdge>* edges,
                               double samples, double points)
    : band_(options.band),
      simd_(options.simd),
      rule_(options.rule_only() ? std::optional<Rule>(options.rule) : std::nullopt),
      thresholds_(options.has_rule() ? thresholds_to_settle(options.rule) : std::vector<double>{}),
      distance_(options.has(Field::kDistance) ? std::optional<DistanceEvaluator>(std::in_place, mesh, options.simd)
                                              : std::nullopt),
      gradient_(gradient_for(mesh, options, edges)),
      winding_number_(std::move(mesh), {.ray_engine = options.engine,
                                        .level = options.simd,
                                        .accuracy = {.tolerance = tolerance_of_evaluation(options),
                                                     .samples = samples,
                                                     .sides_only = options.rule_only(),
                                                     .points = points},
                                        .edges = edges}) {}

void FieldEvaluator::prepare_points() const {
  winding_number_.prepare_points(winding_number_.asked_accuracy().samples);
  if (distance_) distance_->prepare_points();
  if (solid_) solid_->prepare_points();
}

namespace {

// A bound of the value that is replaced holds for the new one with the difference.
void set_settled(FieldSamples& samples, std::size_t n, double settled) {
  double& value = samples.winding_numbers()[n];
  if (samples.diagnostics() && settled != value) {
    double& bound = samples.diagnostics()->error_bound[n];
    bound = std::nextafter(bound + std::abs(settled - value), std::numeric_limits<double>::infinity());
  }
  value = settled;
}

}  // namespace

template <class Point>
void FieldEvaluator::settle(const Point& point, FieldSamples& samples) const {
  const double doubt = winding_number_.doubt();
  if (thresholds_.empty() || doubt == 0.0) return;
  const std::span<double> values = samples.winding_numbers();
  constexpr std::size_t kGrain = std::size_t{1} << 10;
  parallel_for(values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t> doubtful;
    std::vector<Vec3> points;
    std::vector<double> settled;
    for (const double threshold : thresholds_) {
      doubtful.clear(), points.clear(), settled.clear();
      for (std::size_t n = begin; n < end; ++n) {
        if (!may_be_across(values[n], threshold, doubt)) continue;
        doubtful.push_back(n), points.push_back(point(n)), settled.push_back(values[n]);
      }
      winding_number_.settle(points, threshold, settled);
      for (std::size_t i = 0; i < doubtful.size(); ++i) set_settled(samples, doubtful[i], settled[i]);
    }
  });
}

Tally FieldEvaluator::evaluate_along_axes(const Lattice& lattice, const LatticeBlock& block, double band_width,
                                          FieldSamples& samples, std::atomic<std::uint64_t>* done) const {
  const auto count = static_cast<std::size_t>(block.size());
  samples.resize(count, rule_ ? FieldSamples::From::kSides : FieldSamples::From::kWindingNumbers);
  std::atomic<std::uint64_t>* const last = gradient_ ? std::exchange(done, nullptr) : nullptr;
  const Tally tally =
      rule_ ? winding_number_.evaluate_sides(*rule_, lattice, block, samples.sides(), done)
            : winding_number_.evaluate(lattice, block, samples.winding_numbers(), done, samples.diagnostics());
  if (!rule_) settle([&](std::size_t n) { return lattice.position(block.index_of(n)); }, samples);
  if (DistanceBlocks* const blocks = samples.distance_blocks()) {
    distance_->evaluate(lattice, block, band_width, *blocks);
  } else if (distance_) {
    distance_->evaluate(lattice, block, band_width, samples.distances());
  }
  if (solid_) solid_->evaluate(lattice, block, band_width, samples.solid_distances());
  if (gradient_) gradient_->evaluate(lattice, block, samples.gradients(), last);
  samples.derive();
  return tally;
}

Tally FieldEvaluator::evaluate_points(std::span<const Vec3> points, double band_width, FieldSamples& samples,
                                      std::atomic<std::uint64_t>* done) const {
  samples.resize(points.size(), FieldSamples::From::kWindingNumbers);
  std::atomic<std::uint64_t>* const last = gradient_ ? std::exchange(done, nullptr) : nullptr;
  const Tally tally = winding_number_.evaluate(points, samples.winding_numbers(), done, samples.diagnostics());
  settle([&](std::size_t n) { return points[n]; }, samples);
  if (distance_) distance_->evaluate(points, samples.distances());
  if (solid_) solid_->evaluate(points, samples.solid_distances());
  if (std::isfinite(band_width)) {
    for (double& distance : samples.distances()) distance = std::min(distance, band_width);
  }
  if (gradient_) gradient_->evaluate(points, samples.gradients(), last);
  samples.derive();
  return tally;
}

Tally FieldEvaluator::evaluate(std::span<const Vec3> points, FieldSamples& samples,
                               std::atomic<std::uint64_t>* done) const {
  return evaluate_points(points, std::numeric_limits<double>::infinity(), samples, done);
}

Tally FieldEvaluator::evaluate(const PlacedLattice& lattice, const LatticeBlock& block, FieldSamples& samples,
                               std::atomic<std::uint64_t>* done) const {
  const double band_width = band_ * lattice.grid.spacing.x;
  if (lattice.along_axes()) return evaluate_along_axes(lattice.grid, block, band_width, samples, done);
  if (const std::optional<WorldOrder> order = world_order(lattice)) {
    const Tally tally = evaluate_along_axes(order->lattice, order->block_of(block), band_width, samples, done);
    samples.to_index_order(*order, block);
    return tally;
  }
  std::vector<Vec3> points(static_cast<std::size_t>(block.size()));
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  parallel_for_each(points.size(), kGrain, [&](std::size_t n) { points[n] = lattice.position(block, n); });
  return evaluate_points(points, band_width, samples, done);
}

}  // namespace raycone
