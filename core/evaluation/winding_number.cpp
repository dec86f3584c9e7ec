#include "core/evaluation/winding_number.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>

#include "core/crossings/check_counts.h"
#include "core/evaluation/lattice_far.h"
#include "core/evaluation/points.h"
#include "core/evaluation/rows.h"
#include "core/evaluation/scaled_mesh.h"
#include "core/evaluation/settler.h"
#include "core/evaluation/sides.h"
#include "core/machine/floating_point.h"

namespace raycone {
namespace {

// Sets what a mesh without triangles has, 0. Returns whether it is one.
bool set_to_zero_if_empty(const TriangleMesh& mesh, const ValueOutputs& out) {
  if (!mesh.triangles.empty()) return false;
  std::ranges::fill(out.values, 0.0);
  out.count_done(out.values.size());
  if (out.diagnostics) out.diagnostics->set_to_zero();
  return true;
}

}  // namespace

struct WindingNumberEvaluator::Implementation : ScaledMeshes {
  using ScaledMeshes::ScaledMeshes;
};

WindingNumberEvaluator::WindingNumberEvaluator(TriangleMesh mesh, const EvaluatorOptions& options) {
  check_counts(mesh);
  const DefaultFloatingPoint guard;  // scaling must not flush what is tiny; and below
  implementation_ = std::make_unique<Implementation>(std::move(mesh), options);
}
WindingNumberEvaluator::~WindingNumberEvaluator() = default;
WindingNumberEvaluator::WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept = default;
WindingNumberEvaluator& WindingNumberEvaluator::operator=(WindingNumberEvaluator&&) noexcept = default;

std::uint64_t WindingNumberEvaluator::exterior_edges() const {
  return implementation_->scaled().boundary().exterior_edges();
}

const Accuracy& WindingNumberEvaluator::asked_accuracy() const { return implementation_->scaled().options().accuracy; }

// Measured on open meshes at 128 to 512 samples along an axis. No side depends on it.
double tolerance_for_sides(const Rule& rule) { return thresholds_to_settle(rule).empty() ? 3e-5 : 1e-6; }

double WindingNumberEvaluator::doubt() const { return implementation_->scaled().doubt(); }

double WindingNumberEvaluator::error_of_agreeing_roundings() const {
  const ScaledMesh& mesh = implementation_->scaled();
  return mesh.choice().tolerance() + kAgreeingRounding * mesh.boundary().total_multiplicity();
}

double WindingNumberEvaluator::expected_error() const {
  constexpr double u = 0x1p-53;
  const ScaledMesh& mesh = implementation_->scaled();
  return std::max({kLeastTolerance, mesh.choice().tolerance(), u * mesh.boundary().total_multiplicity()});
}

// Each face is scanned once, and each sample written once.
WindingNumberEvaluator::Estimate WindingNumberEvaluator::estimated_seconds(const Lattice& lattice) const {
  constexpr double kPerFace = 25e-9, kPerSample = 3e-9;
  constexpr double kMany = 1 << 17;  // sources
  const DefaultFloatingPoint guard;
  const ScaledMesh& mesh = implementation_->scaled();
  const bool many = !mesh.is_closed() && mesh.choice().most_sources() > kMany;
  const double once = kPerFace * static_cast<double>(mesh.mesh().triangles.size());
  const double boundary = many ? direct_boundary_seconds(mesh, lattice) : boundary_seconds(mesh, lattice);
  return {once + kPerSample * lattice.samples() + boundary, many};
}

Terms WindingNumberEvaluator::terms() const { return implementation_->terms(); }

void WindingNumberEvaluator::settle(std::span<const Vec3> points, double critical, std::span<double> values) const {
  assert(values.size() == points.size());
  const ScaledMesh& scaled = implementation_->scaled();
  if (scaled.is_closed()) return;
  const DefaultFloatingPoint guard;
  Settler settler(scaled, critical, values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (scaled.can_take(points[i])) {
      settler.add(i, scaled.to_scale(points[i]));
      continue;
    }
    const ScaledMesh& unscaled = implementation_->unscaled();
    Settler of_one(unscaled, critical, values);
    of_one.add(i, unscaled.to_scale(points[i]));
    of_one.evaluate();
  }
  settler.evaluate();
}

void WindingNumberEvaluator::prepare_points(double points) const {
  const DefaultFloatingPoint guard;
  const ScaledMesh& scaled = implementation_->scaled();
  if (scaled.mesh().triangles.empty()) return;
  scaled.grid_choice().expect_points(points);
  scaled.prepare_points(points);
}

Tally WindingNumberEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  check_counts(block);
  assert(values.size() == static_cast<std::size_t>(block.size()));
  if (block.size() == 0) return {};
  const ScaledMeshes& meshes = *implementation_;
  const ValueOutputs out{values, done, diagnostics};
  if (set_to_zero_if_empty(meshes.scaled().mesh(), out)) return {};
  const DefaultFloatingPoint guard;
  return evaluate_block(meshes, lattice, block, out);
}

Tally WindingNumberEvaluator::evaluate_sides(const Rule& rule, const Lattice& lattice, const LatticeBlock& block,
                                             std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) const {
  check_counts(block);
  assert(sides.size() == static_cast<std::size_t>(block.size()));
  if (block.size() == 0) return {};
  const ScaledMeshes& meshes = *implementation_;
  if (meshes.scaled().mesh().triangles.empty()) {
    std::ranges::fill(sides, holds(rule, 0.0) ? 1 : 0);
    if (done) done->fetch_add(sides.size(), std::memory_order_relaxed);
    return {};
  }
  const DefaultFloatingPoint guard;
  return evaluate_block_sides(meshes, rule, lattice, block, sides, done);
}

Tally WindingNumberEvaluator::evaluate(std::span<const Vec3> points, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  assert(values.size() == points.size());
  const ScaledMeshes& meshes = *implementation_;
  const ValueOutputs out{values, done, diagnostics};
  if (set_to_zero_if_empty(meshes.scaled().mesh(), out)) return {};
  const DefaultFloatingPoint guard;
  return evaluate_points(meshes, points, out);
}

void WindingNumberEvaluator::evaluate_unsettled(std::span<const Vec3> points, std::span<double> values) const {
  assert(values.size() == points.size());
  const ScaledMeshes& meshes = *implementation_;
  if (set_to_zero_if_empty(meshes.scaled().mesh(), {values})) return;
  const DefaultFloatingPoint guard;
  evaluate_points(meshes, points, {values}, ScaledMesh::Settling::kLeft);
}

}  // namespace raycone
