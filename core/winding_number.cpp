#include "core/winding_number.h"

#include <algorithm>
#include <cassert>
#include <mutex>

#include "core/cone.h"
#include "core/crossings.h"
#include "core/ray_caster.h"
#include "core/row.h"
#include "core/scale.h"
#include "core/threads.h"

namespace raycone {
namespace {

TriangleMesh scaled(TriangleMesh mesh, const PowerOfTwo& scale) {
  for (Vec3& p : mesh.vertices) p = scale(p);
  return mesh;
}

// Queries beyond this are as good as at it: a mesh of size 1 has vanished, and products stay finite.
constexpr double kFarthest = 0x1p1000;

// A query coordinate in the mesh's scale.
double scaled_query(const PowerOfTwo& scale, double x) { return std::clamp(scale(x), -kFarthest, kFarthest); }

// Tallies of threads, added under a lock: sums of integers, so their order does not matter.
class TallySum {
 public:
  void add(const Tally& tally) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sum_ += tally;
  }
  [[nodiscard]] Tally sum() const { return sum_; }

 private:
  std::mutex mutex_;
  Tally sum_;
};

// Buffers of one thread, reused from row to row.
struct Scratch {
  std::vector<std::uint32_t> candidates;
  RowCrossings crossings;
  std::vector<Turns> cone;
};

}  // namespace

struct WindingNumberEvaluator::Implementation {
  PowerOfTwo scale;
  TriangleMesh mesh;  // scaled
  RayCaster rays;
  Cone cone;

  explicit Implementation(TriangleMesh unscaled)
      : scale(unit_scale(unscaled)), mesh(scaled(std::move(unscaled), scale)), rays(mesh), cone(mesh) {}

  // w = n - w_cone at each sample of a row in the mesh's scale.
  Tally evaluate_row(const Row& row, std::span<double> values, Scratch& scratch) const {
    rays.find_candidates(row.query(0), scratch.candidates);
    scratch.crossings.count(mesh, scratch.candidates, row);
    scratch.cone.resize(row.xs.size());
    cone.winding_numbers(row, scratch.cone);
    Tally tally;
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      values[i] = static_cast<double>(scratch.crossings.crossings[i] - scratch.cone[i].whole) - scratch.cone[i].rest;
      tally.degenerate += static_cast<std::uint64_t>(scratch.crossings.degenerate[i]);
      tally.on_surface += scratch.crossings.on_surface[i];
    }
    return tally;
  }
};

WindingNumberEvaluator::WindingNumberEvaluator(TriangleMesh mesh)
    : implementation_(std::make_unique<Implementation>(std::move(mesh))) {}
WindingNumberEvaluator::~WindingNumberEvaluator() = default;
WindingNumberEvaluator::WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept = default;
WindingNumberEvaluator& WindingNumberEvaluator::operator=(WindingNumberEvaluator&&) noexcept = default;

std::uint64_t WindingNumberEvaluator::exterior_edges() const { return implementation_->cone.exterior_edges(); }

Tally WindingNumberEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                                       std::atomic<std::uint64_t>* done) const {
  assert(values.size() == static_cast<std::size_t>(block.size()));
  const Implementation& self = *implementation_;
  const auto table = [&](int axis) {
    const auto a = static_cast<std::size_t>(axis);
    std::vector<double> coordinates(static_cast<std::size_t>(block.counts[a]));
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      const std::int64_t index = block.first[a] + static_cast<std::int64_t>(i);
      coordinates[i] = scaled_query(self.scale, lattice.coordinate(axis, index));
    }
    return coordinates;
  };
  const std::vector<double> xs = table(0), ys = table(1), zs = table(2);
  TallySum total;
  parallel_for(ys.size() * zs.size(), 1, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    Tally tally;
    for (std::size_t i = begin; i < end; ++i) {
      const Row row{ys[i % ys.size()], zs[i / ys.size()], xs};
      tally += self.evaluate_row(row, values.subspan(i * xs.size(), xs.size()), scratch);
      if (done) done->fetch_add(xs.size(), std::memory_order_relaxed);
    }
    total.add(tally);
  });
  return total.sum();
}

Tally WindingNumberEvaluator::evaluate(std::span<const Vec3> points, std::span<double> values,
                                       std::atomic<std::uint64_t>* done) const {
  assert(values.size() == points.size());
  const Implementation& self = *implementation_;
  TallySum total;
  parallel_for(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    Tally tally;
    for (std::size_t i = begin; i < end; ++i) {
      const double x = scaled_query(self.scale, points[i].x);
      const Row row{scaled_query(self.scale, points[i].y), scaled_query(self.scale, points[i].z), {&x, 1}};
      tally += self.evaluate_row(row, values.subspan(i, 1), scratch);
    }
    if (done) done->fetch_add(end - begin, std::memory_order_relaxed);
    total.add(tally);
  });
  return total.sum();
}

}  // namespace raycone
