#include "core/winding_number.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "core/cone.h"
#include "core/crossings.h"
#include "core/lattice_scan.h"
#include "core/projected_grid.h"
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
  std::vector<std::int64_t> sums;
  std::vector<Turns> cone;
  std::vector<TurnsWithin> enclosure;
};

// Diagnostics of the samples [begin, begin + count).
Diagnostics part(const Diagnostics& all, std::size_t begin, std::size_t count) {
  return {all.crossings.subspan(begin, count), all.degenerate.subspan(begin, count),
          all.on_surface.subspan(begin, count), all.error_bound.subspan(begin, count)};
}

Tally tally_of(const RowCrossings& crossings, std::size_t samples) {
  Tally tally;
  for (const RowCrossings::Ending& e : crossings.ties) {
    tally.degenerate += e.samples * static_cast<std::uint64_t>(e.count);
  }
  if (crossings.on_surface.empty()) return tally;
  std::vector<bool> on_surface(samples, false);  // a sample counts once, on however many triangles it lies
  for (const RowCrossings::Range& range : crossings.on_surface) {
    for (std::size_t i = range.begin; i < range.end; ++i) on_surface[i] = true;
  }
  tally.on_surface = static_cast<std::uint64_t>(std::count(on_surface.begin(), on_surface.end(), true));
  return tally;
}

// |w - w2| + the bound of w2 = n - enclosure, rounded up.
double error_bound(double w, std::int64_t n, const TurnsWithin& enclosure) {
  constexpr long double u = std::numeric_limits<long double>::epsilon() / 2;
  const long double w2 = static_cast<long double>(n - enclosure.whole) - enclosure.rest;
  const long double bound = std::abs(w - w2) + enclosure.bound + u * std::abs(w2);
  return std::nextafter(static_cast<double>(bound * (1 + 8 * u)), std::numeric_limits<double>::infinity());
}

// Candidate triangles of single rays.
class Candidates {
 public:
  Candidates(const TriangleMesh& mesh, RayEngine engine) {
    // With more candidates per cell a query takes longer than Embree's descent.
    constexpr double kMostCandidates = 64;
    if (engine == RayEngine::kScan) grid_.emplace(mesh);
    if (!grid_ || grid_->expected_candidates() > kMostCandidates) {
      rays_.emplace(mesh);
      grid_.reset();
    }
  }

  void find(const Vec3& origin, std::vector<std::uint32_t>& candidates) const {
    if (grid_) {
      grid_->find_candidates(origin, candidates);
    } else {
      rays_->find_candidates(origin, candidates);
    }
  }

  // Queries in the order of this number are close together.
  [[nodiscard]] std::uint64_t place(const Vec3& origin) const { return grid_ ? grid_->cell_of(origin) : 0; }

 private:
  std::optional<ProjectedGrid> grid_;
  std::optional<RayCaster> rays_;
};

// The mesh in one scale, with all that is needed to evaluate rows in that scale.
class Engine {
 public:
  Engine(TriangleMesh mesh, const PowerOfTwo& scale, RayEngine engine)
      : scale_(scale),
        inverse_(-scale.exponent()),
        engine_(engine),
        mesh_(in_scale(std::move(mesh), scale)),
        cone_(mesh_) {}
  Engine(const Engine&) = delete;  // candidates_ refers to mesh_
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] RayEngine engine() const { return engine_; }
  [[nodiscard]] const Cone& cone() const { return cone_; }
  [[nodiscard]] const Candidates& candidates() const {
    std::call_once(candidates_built_, [this] { candidates_.emplace(mesh_, engine_); });
    return *candidates_;
  }
  // The mesh as it was given: the scaling lost nothing.
  [[nodiscard]] TriangleMesh unscaled_mesh() const { return in_scale(mesh_, inverse_); }

  // Whether scaling a query coordinate loses nothing that a predicate could see.
  [[nodiscard]] bool can_take(double x) const {
    const double y = scale_(x);
    return inverse_(y) == x || std::abs(y) > kFarthest;
  }
  [[nodiscard]] bool can_take(const Vec3& q) const { return can_take(q.x) && can_take(q.y) && can_take(q.z); }

  [[nodiscard]] double to_scale(double x) const { return std::clamp(scale_(x), -kFarthest, kFarthest); }
  [[nodiscard]] Vec3 to_scale(const Vec3& q) const { return {to_scale(q.x), to_scale(q.y), to_scale(q.z)}; }

  // Sets scratch.crossings to what the candidate triangles say about a row.
  void find_crossings(const Row& row, Scratch& scratch) const {
    candidates().find(row.query(0), scratch.candidates);
    scratch.crossings.clear();
    for (const std::uint32_t candidate : scratch.candidates) {
      const Triangle& t = mesh_.triangles[candidate];
      scratch.crossings.add(
          triangle_crossing(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], row, nullptr));
    }
  }

  // w = n - w_cone at each sample of a row in the engine's scale, n from scratch.crossings.
  Tally evaluate_row(const Row& row, std::span<double> values, const Diagnostics* diagnostics, Scratch& scratch) const {
    scratch.sums.resize(row.xs.size());
    RowCrossings::sum(scratch.crossings.crossings, scratch.sums);
    if (cone_.exterior_edges() > 0) {
      scratch.cone.resize(row.xs.size());
      cone_.winding_numbers(row, scratch.cone);
      for (std::size_t i = 0; i < row.xs.size(); ++i) {
        values[i] = static_cast<double>(scratch.sums[i] - scratch.cone[i].whole) - scratch.cone[i].rest;
      }
    } else {
      std::copy(scratch.sums.begin(), scratch.sums.end(), values.begin());
    }
    if (diagnostics) diagnose(row, values, *diagnostics, scratch);
    return tally_of(scratch.crossings, row.xs.size());
  }

 private:
  void diagnose(const Row& row, std::span<const double> values, const Diagnostics& diagnostics,
                Scratch& scratch) const {
    const bool open = cone_.exterior_edges() > 0;
    scratch.enclosure.resize(row.xs.size());
    if (open) cone_.enclose(row, scratch.enclosure);
    for (std::size_t i = 0; i < row.xs.size(); ++i) {
      diagnostics.crossings[i] = scratch.sums[i];
      diagnostics.on_surface[i] = 0;
      diagnostics.error_bound[i] = open ? error_bound(values[i], scratch.sums[i], scratch.enclosure[i]) : 0.0;
    }
    RowCrossings::sum(scratch.crossings.ties, diagnostics.degenerate);
    for (const RowCrossings::Range& range : scratch.crossings.on_surface) {
      for (std::size_t i = range.begin; i < range.end; ++i) diagnostics.on_surface[i] = 1;
    }
  }

  PowerOfTwo scale_;
  PowerOfTwo inverse_;
  RayEngine engine_;
  TriangleMesh mesh_;
  Cone cone_;
  mutable std::once_flag candidates_built_;
  mutable std::optional<Candidates> candidates_;
};

// The rows of a block in an engine's scale.
LatticeRows rows_of(const std::array<std::vector<double>, 3>& coordinates, const Engine& engine) {
  LatticeRows rows;
  const std::array<std::vector<double>*, 3> axes{&rows.xs, &rows.ys, &rows.zs};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double x : coordinates[axis]) axes[axis]->push_back(engine.to_scale(x));
    const double width = axes[axis]->back() - axes[axis]->front();
    const double per_unit = static_cast<double>(axes[axis]->size() - 1) / width;
    rows.samples_per_unit[static_cast<int>(axis)] = std::isfinite(per_unit) ? per_unit : 0.0;
  }
  return rows;
}

// Layers [begin, end) of a block's rows.
LatticeRows layers(const LatticeRows& rows, std::size_t begin, std::size_t end) {
  LatticeRows some{rows.xs, rows.ys, {}, rows.samples_per_unit};
  some.zs.assign(rows.zs.begin() + static_cast<std::ptrdiff_t>(begin),
                 rows.zs.begin() + static_cast<std::ptrdiff_t>(end));
  return some;
}

// Evaluates rows; those of `scan` where given, else by their candidates.
Tally evaluate_rows(const Engine& engine, const LatticeRows& rows, const LatticeScan* scan, std::span<double> values,
                    std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) {
  const std::size_t samples = rows.xs.size();
  TallySum total;
  parallel_for(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    Tally tally;
    for (std::size_t i = begin; i < end; ++i) {
      const Row row = rows.row(i);
      if (scan) {
        scan->get(i, scratch.crossings);
      } else {
        engine.find_crossings(row, scratch);
      }
      const Diagnostics of_row = diagnostics ? part(*diagnostics, i * samples, samples) : Diagnostics{};
      tally += engine.evaluate_row(row, values.subspan(i * samples, samples), diagnostics ? &of_row : nullptr, scratch);
      if (done) done->fetch_add(samples, std::memory_order_relaxed);
    }
    total.add(tally);
  });
  return total.sum();
}

}  // namespace

struct WindingNumberEvaluator::Implementation {
  Engine scaled;

  Implementation(TriangleMesh mesh, const PowerOfTwo& scale, RayEngine engine)
      : scaled(std::move(mesh), scale, engine) {}

  // The engine for queries with these coordinates: where scaling would drop bits of one (a number below 1e-290 mesh
  // sizes), the mesh as it is, in which predicates are slower. Built when first needed.
  [[nodiscard]] const Engine& engine_for(bool scaling_is_exact) const {
    if (scaling_is_exact) return scaled;
    std::call_once(unscaled_built,
                   [this] { unscaled.emplace(scaled.unscaled_mesh(), PowerOfTwo(0), scaled.engine()); });
    return *unscaled;
  }

 private:
  mutable std::once_flag unscaled_built;
  mutable std::optional<Engine> unscaled;
};

WindingNumberEvaluator::WindingNumberEvaluator(TriangleMesh mesh, RayEngine engine) {
  const PowerOfTwo scale = unit_scale(mesh);
  implementation_ = std::make_unique<Implementation>(std::move(mesh), scale, engine);
}
WindingNumberEvaluator::~WindingNumberEvaluator() = default;
WindingNumberEvaluator::WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept = default;
WindingNumberEvaluator& WindingNumberEvaluator::operator=(WindingNumberEvaluator&&) noexcept = default;

std::uint64_t WindingNumberEvaluator::exterior_edges() const { return implementation_->scaled.cone().exterior_edges(); }

void WindingNumberEvaluator::prepare_points() const { (void)implementation_->scaled.candidates(); }

Tally WindingNumberEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  assert(values.size() == static_cast<std::size_t>(block.size()));
  std::array<std::vector<double>, 3> coordinates;
  bool exact = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::int64_t i = 0; i < block.counts[axis]; ++i) {
      coordinates[axis].push_back(lattice.coordinate(static_cast<int>(axis), block.first[axis] + i));
      exact = exact && implementation_->scaled.can_take(coordinates[axis].back());
    }
  }
  const Engine& engine = implementation_->engine_for(exact);
  const LatticeRows rows = rows_of(coordinates, engine);
  if (engine.engine() == RayEngine::kEmbree) return evaluate_rows(engine, rows, nullptr, values, done, diagnostics);

  constexpr std::size_t kRowsPerScan = std::size_t{1} << 20;  // bounds the memory of crossings waiting for their row
  const std::size_t step = std::max<std::size_t>(1, kRowsPerScan / rows.ys.size());
  Tally tally;
  for (std::size_t k = 0; k < rows.zs.size(); k += step) {
    const LatticeRows some = layers(rows, k, std::min(k + step, rows.zs.size()));
    const std::size_t first = k * rows.ys.size() * rows.xs.size(), count = some.size() * rows.xs.size();
    const LatticeScan scan(engine.mesh(), some);
    const Diagnostics of_layers = diagnostics ? part(*diagnostics, first, count) : Diagnostics{};
    tally += evaluate_rows(engine, some, &scan, values.subspan(first, count), done, diagnostics ? &of_layers : nullptr);
  }
  return tally;
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
      const Vec3 q = engine.to_scale(points[i]);
      const Row row{q.y, q.z, {&q.x, 1}};
      engine.find_crossings(row, scratch);
      const Diagnostics of_point = diagnostics ? part(*diagnostics, i, 1) : Diagnostics{};
      tally += engine.evaluate_row(row, values.subspan(i, 1), diagnostics ? &of_point : nullptr, scratch);
    }
    if (done) done->fetch_add(end - begin, std::memory_order_relaxed);
    total.add(tally);
  });
  return total.sum();
}

}  // namespace raycone
