#include "core/evaluation/point_tile.h"

#include <algorithm>
#include <cassert>

namespace raycone {

Tally PointTile::evaluate(const ScaledMesh& mesh, PointBlocks::Sums* sums) {
  Tally tally;
  if (count_ == 0) return tally;
  find_crossings(mesh);
  for (std::size_t i = 0; i < count_; ++i) tally += tallies_[i];
  set_values(mesh, sums);
  if (diagnostics_) set_diagnostics(mesh);
  count_ = 0;
  return tally;
}

// First what is certain, then what predicates decide.
void PointTile::find_crossings(const ScaledMesh& mesh) {
  if (crossings_) return look_up();
  std::fill_n(tallies_.begin(), count_, Tally{});
  if (mesh.options().ray_engine == RayEngine::kEmbree) {
    ask_embree(mesh);
  } else {
    assert(mesh.grid_if_built());  // within this loop threads would wait for one another
    doubtful_.clear();
    mesh.grid().crossings({queries_.data(), count_}, {n_.data(), count_}, doubtful_);
    for (const RayCandidate& candidate : doubtful_) decide(mesh, candidate);
  }
}

void PointTile::ask_embree(const ScaledMesh& mesh) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    n_[i] = 0;
    mesh.rays().find_candidates(queries_[i], candidates_);
    for (const std::uint32_t triangle : candidates_) decide(mesh, {i, triangle});
  }
}

void PointTile::look_up() {
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t ray = rays_[i];
    n_[i] = crossings_->n[ray];
    tallies_[i] = {crossings_->ties[ray], crossings_->on_surface[ray]};
  }
}

void PointTile::decide(const ScaledMesh& mesh, const RayCandidate& candidate) {
  const auto& [i, triangle] = candidate;
  const QueryCrossing crossing = mesh.crossing(triangle, queries_[i]);
  n_[i] += crossing.sigma;
  tallies_[i].degenerate += static_cast<std::uint64_t>(crossing.ties);
  if (crossing.on_surface) tallies_[i].on_surface = 1;
}

void PointTile::set_values(const ScaledMesh& mesh, PointBlocks::Sums* sums) {
  if (mesh.is_closed()) {
    std::transform(n_.begin(), n_.begin() + count_, w_.begin(), [](std::int64_t n) { return static_cast<double>(n); });
  } else {
    samples_.clear();
    for (std::size_t i = 0; i < count_; ++i) samples_.add(queries_[i]);
    const std::span<const std::int64_t> n(n_.data(), count_);
    const std::span<double> w(w_.data(), count_);
    if (sums) {
      mesh.set_values(*sums, samples_, n, w, settling_);
    } else {
      mesh.set_values(samples_, n, w, settling_);
    }
  }
  for (std::size_t i = 0; i < count_; ++i) values_[indices_[i]] = w_[i];
}

void PointTile::set_diagnostics(const ScaledMesh& mesh) {
  std::array<double, kTile> bounds;
  samples_.clear();
  for (std::size_t i = 0; i < count_; ++i) samples_.add(queries_[i]);
  mesh.bound_errors(samples_, {w_.data(), count_}, {n_.data(), count_}, {bounds.data(), count_});
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t index = indices_[i];
    diagnostics_->crossings[index] = n_[i];
    diagnostics_->degenerate[index] = static_cast<std::int64_t>(tallies_[i].degenerate);
    diagnostics_->on_surface[index] = static_cast<std::uint8_t>(tallies_[i].on_surface);
    diagnostics_->error_bound[index] = bounds[i];
  }
}

}  // namespace raycone
