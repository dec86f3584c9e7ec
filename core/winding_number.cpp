#include "core/winding_number.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/cone.h"
#include "core/crossings.h"
#include "core/ray_caster.h"
#include "core/row.h"
#include "core/scale.h"
#include "core/threads.h"

namespace raycone {
namespace {

TriangleMesh in_scale(TriangleMesh mesh, const PowerOfTwo& scale) {
  for (Vec3& p : mesh.vertices) p = scale(p);
  return mesh;
}

// Queries beyond this are as good as at it: a mesh of size 1 has vanished, and products stay finite.
constexpr double kFarthest = 0x1p1000;

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
  std::vector<TurnsWithin> enclosure;
};

// Diagnostics of the samples [begin, begin + count).
Diagnostics part(const Diagnostics& all, std::size_t begin, std::size_t count) {
  return {all.crossings.subspan(begin, count), all.degenerate.subspan(begin, count),
          all.on_surface.subspan(begin, count), all.error_bound.subspan(begin, count)};
}

// |w - w2| + the bound of w2 = n - enclosure, rounded up.
double error_bound(double w, std::int64_t n, const TurnsWithin& enclosure) {
  constexpr long double u = std::numeric_limits<long double>::epsilon() / 2;
  const long double w2 = static_cast<long double>(n - enclosure.whole) - enclosure.rest;
  const long double bound = std::abs(w - w2) + enclosure.bound + u * std::abs(w2);
  return std::nextafter(static_cast<double>(bound * (1 + 8 * u)), std::numeric_limits<double>::infinity());
}

// The mesh in one scale, with all that is needed to evaluate rows in that scale.
class Engine {
 public:
  Engine(TriangleMesh mesh, const PowerOfTwo& scale)
      : scale_(scale),
        inverse_(-scale.exponent()),
        mesh_(in_scale(std::move(mesh), scale)),
        rays_(mesh_),
        cone_(mesh_) {}
  Engine(const Engine&) = delete;  // rays_ refers to mesh_
  Engine& operator=(const Engine&) = delete;

  // The mesh as it was given: the scaling lost nothing.
  [[nodiscard]] TriangleMesh unscaled_mesh() const { return in_scale(mesh_, inverse_); }

  [[nodiscard]] const Cone& cone() const { return cone_; }

  // Whether scaling a query coordinate loses nothing that a predicate could see.
  [[nodiscard]] bool can_take(double x) const {
    const double y = scale_(x);
    return inverse_(y) == x || std::abs(y) > kFarthest;
  }
  [[nodiscard]] bool can_take(const Vec3& q) const { return can_take(q.x) && can_take(q.y) && can_take(q.z); }

  [[nodiscard]] double to_scale(double x) const { return std::clamp(scale_(x), -kFarthest, kFarthest); }

  // w = n - w_cone at each sample of a row in the engine's scale.
  Tally evaluate_row(const Row& row, std::span<double> values, const Diagnostics* diagnostics, Scratch& scratch) const {
    rays_.find_candidates(row.query(0), scratch.candidates);
    scratch.crossings.count(mesh_, scratch.candidates, row);
    scratch.cone.resize(row.xs.size());
    cone_.winding_numbers(row, scratch.cone);
    Tally tally;
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      values[i] = static_cast<double>(scratch.crossings.crossings[i] - scratch.cone[i].whole) - scratch.cone[i].rest;
      tally.degenerate += static_cast<std::uint64_t>(scratch.crossings.degenerate[i]);
      tally.on_surface += scratch.crossings.on_surface[i];
    }
    if (diagnostics) diagnose(row, values, *diagnostics, scratch);
    return tally;
  }

 private:
  void diagnose(const Row& row, std::span<const double> values, const Diagnostics& diagnostics,
                Scratch& scratch) const {
    scratch.enclosure.resize(row.xs.size());
    if (cone_.exterior_edges() > 0) cone_.enclose(row, scratch.enclosure);
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      const std::int64_t n = scratch.crossings.crossings[i];
      diagnostics.crossings[i] = n;
      diagnostics.degenerate[i] = scratch.crossings.degenerate[i];
      diagnostics.on_surface[i] = scratch.crossings.on_surface[i];
      diagnostics.error_bound[i] = cone_.exterior_edges() > 0 ? error_bound(values[i], n, scratch.enclosure[i]) : 0.0;
    }
  }

  PowerOfTwo scale_;
  PowerOfTwo inverse_;
  TriangleMesh mesh_;
  RayCaster rays_;
  Cone cone_;
};

}  // namespace

struct WindingNumberEvaluator::Implementation {
  Engine scaled;

  explicit Implementation(TriangleMesh mesh, const PowerOfTwo& scale) : scaled(std::move(mesh), scale) {}

  // The engine for queries with these coordinates: where scaling would drop bits of one (a number below 1e-290 mesh
  // sizes), the mesh as it is, in which predicates are slower. Built when first needed.
  [[nodiscard]] const Engine& engine_for(bool scaling_is_exact) const {
    if (scaling_is_exact) return scaled;
    std::call_once(unscaled_built,
                   [this] { unscaled = std::make_unique<Engine>(scaled.unscaled_mesh(), PowerOfTwo(0)); });
    return *unscaled;
  }

 private:
  mutable std::once_flag unscaled_built;
  mutable std::unique_ptr<Engine> unscaled;
};

WindingNumberEvaluator::WindingNumberEvaluator(TriangleMesh mesh) {
  const PowerOfTwo scale = unit_scale(mesh);
  implementation_ = std::make_unique<Implementation>(std::move(mesh), scale);
}
WindingNumberEvaluator::~WindingNumberEvaluator() = default;
WindingNumberEvaluator::WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept = default;
WindingNumberEvaluator& WindingNumberEvaluator::operator=(WindingNumberEvaluator&&) noexcept = default;

std::uint64_t WindingNumberEvaluator::exterior_edges() const { return implementation_->scaled.cone().exterior_edges(); }

Tally WindingNumberEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  assert(values.size() == static_cast<std::size_t>(block.size()));
  std::array<std::vector<double>, 3> coordinates;
  bool exact = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::int64_t i = 0; i < block.counts[axis]; ++i) {
      const double x = lattice.coordinate(static_cast<int>(axis), block.first[axis] + i);
      coordinates[axis].push_back(x);
      exact = exact && implementation_->scaled.can_take(x);
    }
  }
  const Engine& engine = implementation_->engine_for(exact);
  for (std::vector<double>& axis : coordinates) {
    for (double& x : axis) x = engine.to_scale(x);
  }
  const auto& [xs, ys, zs] = coordinates;
  TallySum total;
  parallel_for(ys.size() * zs.size(), 1, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    Tally tally;
    for (std::size_t i = begin; i < end; ++i) {
      const Row row{ys[i % ys.size()], zs[i / ys.size()], xs};
      const Diagnostics of_row = diagnostics ? part(*diagnostics, i * xs.size(), xs.size()) : Diagnostics{};
      tally +=
          engine.evaluate_row(row, values.subspan(i * xs.size(), xs.size()), diagnostics ? &of_row : nullptr, scratch);
      if (done) done->fetch_add(xs.size(), std::memory_order_relaxed);
    }
    total.add(tally);
  });
  return total.sum();
}

Tally WindingNumberEvaluator::evaluate(std::span<const Vec3> points, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  assert(values.size() == points.size());
  TallySum total;
  parallel_for(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    Tally tally;
    for (std::size_t i = begin; i < end; ++i) {
      const Engine& engine = implementation_->engine_for(implementation_->scaled.can_take(points[i]));
      const double x = engine.to_scale(points[i].x);
      const Row row{engine.to_scale(points[i].y), engine.to_scale(points[i].z), {&x, 1}};
      const Diagnostics of_point = diagnostics ? part(*diagnostics, i, 1) : Diagnostics{};
      tally += engine.evaluate_row(row, values.subspan(i, 1), diagnostics ? &of_point : nullptr, scratch);
    }
    if (done) done->fetch_add(end - begin, std::memory_order_relaxed);
    total.add(tally);
  });
  return total.sum();
}

}  // namespace raycone
