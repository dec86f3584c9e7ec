#include "core/evaluation/winding_number.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/boundary/cone.h"
#include "core/boundary/solid_angles.h"
#include "core/crossings/crossings.h"
#include "core/crossings/lattice_scan.h"
#include "core/crossings/lattice_sums.h"
#include "core/crossings/projected_grid.h"
#include "core/crossings/ray_caster.h"
#include "core/crossings/row.h"
#include "core/crossings/slab_order.h"
#include "core/crossings/check_counts.h"
#include "core/evaluation/block_parts.h"
#include "core/exact/scale.h"
#include "core/machine/buckets.h"
#include "core/machine/floating_point.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

TriangleMesh in_scale(TriangleMesh mesh, const PowerOfTwo& scale) {
  for (Vec3& p : mesh.vertices) p = scale(p);
  return mesh;
}

// Queries that scaling up brings beyond this are as good as at it: a mesh of size 1 has vanished.
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
  std::vector<std::int64_t> sums;
  SampleTile tile;
  std::array<Turns, kTile> turns;
};

// Diagnostics of the samples [begin, begin + count).
Diagnostics part(const Diagnostics& all, std::size_t begin, std::size_t count) {
  return {all.crossings.subspan(begin, count), all.degenerate.subspan(begin, count),
          all.on_surface.subspan(begin, count), all.error_bound.subspan(begin, count)};
}

// |w - w2| + the bound of w2 = n - enclosure, rounded up.
double error_bound(double w, std::int64_t n, const TurnsWithin<long double>& enclosure) {
  constexpr long double u = std::numeric_limits<long double>::epsilon() / 2;
  const long double w2 = static_cast<long double>(n - enclosure.whole) - enclosure.rest;
  const long double bound = std::abs(w - w2) + enclosure.bound + u * std::abs(w2);
  return std::nextafter(static_cast<double>(bound * (1 + 8 * u)), std::numeric_limits<double>::infinity());
}

// No factor that double precision is trusted with has an argument that is off by more, in turns, its part of the
// product's rounding included; those of a triangle not by more than three times this (docs/method.md, "Rules").
constexpr double kDoubtPerEdge = 0x1p-41;
constexpr double kMostDoubt = 0.125;  // as Cone::settle() wants it; met at 10^11 edges

// What all triangles say about one point.
struct PointCrossings {
  std::int64_t n = 0;  // the sum of the signs of the ray's crossings
  std::int64_t ties = 0;
  bool on_surface = false;

  void add(const TriangleCrossing& crossing) {
    if (crossing.crossed > 0) n += crossing.sigma;
    if (crossing.met > 0) ties += crossing.ties;
    on_surface = on_surface || crossing.on_begin < crossing.on_end;
  }
};

// The mesh in one scale, with all that is needed to evaluate rows in that scale.
class Engine {
 public:
  Engine(TriangleMesh mesh, const PowerOfTwo& scale, RayEngine engine, SimdLevel level, Summation summation)
      : scale_(scale),
        inverse_(-scale.exponent()),
        least_(scale.exponent() >= 0 ? 0.0 : inverse_(std::numeric_limits<double>::min())),
        engine_(engine),
        level_(level),
        summation_(summation),
        mesh_(in_scale(std::move(mesh), scale)),
        cone_(mesh_, level) {
    const bool cheaper = SolidAngles::are_cheaper(mesh_.triangles.size(), cone_.exterior_edges());
    const bool wanted = summation == Summation::kTriangles || (summation == Summation::kCheapest && cheaper);
    if (wanted && cone_.exterior_edges() > 0) solid_angles_.emplace(mesh_, level);
    if (solid_angles_ && solid_angles_->has_crowds() && summation == Summation::kCheapest) solid_angles_.reset();
    doubt_ = std::min(kDoubtPerEdge * cone_.total_multiplicity(), kMostDoubt);
    if (solid_angles_) doubt_ = std::min(3 * kDoubtPerEdge * solid_angles_->triangles(), kMostDoubt);
  }
  Engine(const Engine&) = delete;  // rays_ refers to mesh_
  Engine& operator=(const Engine&) = delete;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] RayEngine engine() const { return engine_; }
  [[nodiscard]] SimdLevel level() const { return level_; }
  [[nodiscard]] Summation summation() const { return summation_; }
  [[nodiscard]] const Cone& cone() const { return cone_; }
  [[nodiscard]] double doubt() const { return doubt_; }
  // Built when first needed: lattices may need neither.
  [[nodiscard]] const RayCaster& rays() const {
    std::call_once(rays_built_, [this] { rays_.emplace(mesh_); });
    return *rays_;
  }
  [[nodiscard]] const ProjectedGrid& grid() const {
    std::call_once(grid_built_, [this] { grid_.emplace(mesh_); });
    return *grid_;
  }
  // Along axis 1 or 2.
  [[nodiscard]] const SlabOrder& slab_order(int axis) const {
    const auto n = static_cast<std::size_t>(axis - 1);
    std::call_once(slab_orders_built_[n], [&] { slab_orders_[n].emplace(mesh_, axis); });
    return *slab_orders_[n];
  }
  // The mesh as it was given: the scaling lost nothing.
  [[nodiscard]] TriangleMesh unscaled_mesh() const { return in_scale(mesh_, inverse_); }

  // Whether scaling a query coordinate loses nothing that a predicate could see: scaled down, it may not become
  // subnormal, even where it would keep its bits; so that on an axis of a lattice few intervals answer alike.
  [[nodiscard]] bool can_take(double x) const { return std::abs(x) >= least_ || x == 0.0; }
  [[nodiscard]] bool can_take(const Vec3& q) const { return can_take(q.x) && can_take(q.y) && can_take(q.z); }

  [[nodiscard]] double to_scale(double x) const {
    return scale_.exponent() > 0 ? std::clamp(scale_(x), -kFarthest, kFarthest) : scale_(x);
  }
  [[nodiscard]] Vec3 to_scale(const Vec3& q) const { return {to_scale(q.x), to_scale(q.y), to_scale(q.z)}; }

  void prepare_points() const {
    if (engine_ == RayEngine::kScan) {
      (void)grid();
    } else {
      (void)rays();
    }
  }

  // Collects what the candidate triangles of a row say.
  void find_crossings(const LatticeRows& rows, std::size_t number, LatticeSums::Collector& collector,
                      Scratch& scratch) const {
    const Row row = rows.row(number);
    rays().find_candidates(row.query(0), scratch.candidates);
    for (const std::uint32_t triangle : scratch.candidates) collector.add(number, crossing(triangle, row));
  }

  // Whether values depend on how many triangles a ray crosses.
  [[nodiscard]] bool counts_crossings() const { return !solid_angles_; }

  // w at the points, which are in the engine's scale.
  Tally evaluate_points(std::span<const Vec3> points, std::span<double> values, const Diagnostics* diagnostics,
                        Scratch& scratch) const {
    Tally tally;
    std::vector<std::int64_t>& n = scratch.sums;
    n.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const PointCrossings crossings = crossings_at(points[i], scratch);
      n[i] = crossings.n;
      tally += {static_cast<std::uint64_t>(crossings.ties), crossings.on_surface ? 1U : 0U};
      if (!diagnostics) continue;
      diagnostics->degenerate[i] = crossings.ties;
      diagnostics->on_surface[i] = crossings.on_surface ? 1 : 0;
    }
    set_values(
        n, [&](std::size_t i) { return points[i]; }, values, scratch);
    for (std::size_t i = 0; diagnostics && i < points.size(); ++i) {
      diagnostics->crossings[i] = n[i];
      diagnostics->error_bound[i] = error_bound_at(points[i], values[i], n[i]);
    }
    return tally;
  }

  // values[i] = w(query(i)), n[i] its crossings.
  template <class Query>
  void set_values(std::span<const std::int64_t> n, const Query& query, std::span<double> values,
                  Scratch& scratch) const {
    if (cone_.exterior_edges() == 0) {
      std::copy(n.begin(), n.end(), values.begin());
      return;
    }
    for (std::size_t begin = 0; begin < n.size(); begin += kTile) {
      scratch.tile.clear();
      for (std::size_t i = begin; i < std::min(begin + kTile, n.size()); ++i) scratch.tile.add(query(i));
      const std::span<Turns> turns(scratch.turns.data(), scratch.tile.count);
      if (solid_angles_) {
        solid_angles_->winding_numbers(scratch.tile, turns);
      } else {
        cone_.winding_numbers(scratch.tile, turns);
      }
      for (std::size_t i = 0; i < turns.size(); ++i) {
        values[begin + i] = solid_angles_ ? static_cast<double>(turns[i].whole) + turns[i].rest
                                          : static_cast<double>(n[begin + i] - turns[i].whole) - turns[i].rest;
      }
      settle_halves(scratch.tile, values.subspan(begin, scratch.tile.count));
    }
  }

  // A value that may be a half-integer, where rules have their thresholds, is on the right side of it or is it.
  void settle_halves(const SampleTile& tile, std::span<double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double nearest_integer = (values[i] + 0x1.8p52) - 0x1.8p52;
      if (0.5 - std::abs(values[i] - nearest_integer) > doubt_) continue;
      const Vec3 q{tile.x[i], tile.y[i], tile.z[i]};
      values[i] = cone_.settle(q, values[i], std::floor(values[i]) + 0.5);
    }
  }

  [[nodiscard]] double error_bound_at(const Vec3& q, double w, std::int64_t n) const {
    return cone_.exterior_edges() > 0 ? error_bound(w, n, cone_.enclose(q)) : 0.0;
  }

 private:
  [[nodiscard]] PointCrossings crossings_at(const Vec3& q, Scratch& scratch) const {
    PointCrossings result;
    const auto decide = [&](std::uint32_t triangle) { result.add(crossing(triangle, {q.y, q.z, {&q.x, 1}})); };
    if (engine_ == RayEngine::kScan) {
      result.n += grid().crossings(q, decide);
    } else {
      rays().find_candidates(q, scratch.candidates);
      for (const std::uint32_t triangle : scratch.candidates) decide(triangle);
    }
    return result;
  }

  [[nodiscard]] TriangleCrossing crossing(std::uint32_t triangle, const Row& row) const {
    const Triangle& t = mesh_.triangles[triangle];
    return triangle_crossing(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]], row, nullptr);
  }

  PowerOfTwo scale_;
  PowerOfTwo inverse_;
  double least_;  // magnitude of query coordinates, beside 0, that scaling keeps
  RayEngine engine_;
  SimdLevel level_;
  Summation summation_;
  TriangleMesh mesh_;
  Cone cone_;
  double doubt_ = 0.0;                       // no value is off by more
  std::optional<SolidAngles> solid_angles_;  // where they take the cone's place
  mutable std::once_flag rays_built_, grid_built_;
  mutable std::array<std::once_flag, 2> slab_orders_built_;
  mutable std::array<std::optional<SlabOrder>, 2> slab_orders_;
  mutable std::optional<RayCaster> rays_;
  mutable std::optional<ProjectedGrid> grid_;
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

// Samples of a lattice that are evaluated together, and where their values belong.
class LatticeTile {
 public:
  [[nodiscard]] bool full() const { return count_ == kTile; }

  void add(std::size_t index, const Vec3& scaled_query) {
    indices_[count_] = index;
    queries_[count_++] = scaled_query;
  }

  // Turns the crossings of the samples, if any, into winding numbers, and forgets them.
  void evaluate(const Engine& engine, std::span<double> values) {
    std::array<std::int64_t, kTile> n{};
    std::array<double, kTile> w;
    if (engine.counts_crossings()) {
      for (std::size_t i = 0; i < count_; ++i) n[i] = static_cast<std::int64_t>(values[indices_[i]]);
    }
    const auto query = [this](std::size_t i) { return queries_[i]; };
    engine.set_values({n.data(), count_}, query, {w.data(), count_}, scratch_);
    for (std::size_t i = 0; i < count_; ++i) values[indices_[i]] = w[i];
    count_ = 0;
  }

 private:
  std::size_t count_ = 0;
  std::array<std::size_t, kTile> indices_;
  std::array<Vec3, kTile> queries_;
  Scratch scratch_;
};

// Turns crossings of the rows [begin, end) into winding numbers. Samples of a row share a ray, which saves work; where
// a row leaves fewer than fill the lanes, those of several rows are taken together.
void add_cone(const Engine& engine, const LatticeRows& rows, std::size_t begin, std::size_t end,
              std::span<double> values) {
  constexpr std::size_t kAlone = 8;  // samples
  const std::size_t samples = rows.xs.size();
  LatticeTile along, across;
  for (std::size_t number = begin; number < end; ++number) {
    const Row row = rows.row(number);
    for (std::size_t first = 0; first < samples; first += kTile) {
      const std::size_t last = std::min(first + kTile, samples);
      LatticeTile& tile = last - first >= kAlone ? along : across;
      for (std::size_t i = first; i < last; ++i) {
        tile.add(number * samples + i, row.query(i));
        if (tile.full()) tile.evaluate(engine, values);
      }
      along.evaluate(engine, values);
    }
  }
  across.evaluate(engine, values);
}

void bound_errors(const Engine& engine, const LatticeRows& rows, std::size_t begin, std::size_t end,
                  std::span<const double> values, const Diagnostics& diagnostics) {
  const std::size_t samples = rows.xs.size();
  for (std::size_t n = begin * samples; n < end * samples; ++n) {
    const Vec3 query = rows.row(n / samples).query(n % samples);
    diagnostics.error_bound[n] = engine.error_bound_at(query, values[n], diagnostics.crossings[n]);
  }
}

// What all triangles say about the rows.
void find_crossings(const Engine& engine, const LatticeRows& rows, const std::optional<OrderedSlab>& slab,
                    LatticeSums& sums) {
  if (engine.engine() == RayEngine::kScan) return scan_triangles(engine.mesh(), rows, slab, sums);
  parallel_for(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    Scratch scratch;
    for (std::size_t number = begin; number < end; ++number) engine.find_crossings(rows, number, collector, scratch);
    collector.finish();
  });
}

Tally evaluate_rows(const Engine& engine, const LatticeRows& rows, const std::optional<OrderedSlab>& slab,
                    std::span<double> values, std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) {
  const bool counts = engine.counts_crossings() || diagnostics;
  LatticeSums sums(rows.size(), rows.xs.size(), counts ? values : std::span<double>(), diagnostics);
  find_crossings(engine, rows, slab, sums);
  sums.arrange();
  std::atomic<std::uint64_t> on_surface = 0;
  const std::size_t rows_per_task = std::max<std::size_t>(1, 4 * kTile / rows.xs.size());
  parallel_for(rows.size(), rows_per_task, [&](std::size_t first, std::size_t last) {
    std::uint64_t here = 0;
    for (std::size_t begin = first; begin < last; begin += rows_per_task) {
      const std::size_t end = std::min(begin + rows_per_task, last);
      for (std::size_t row = begin; row < end; ++row) here += sums.finish(row);
      if (engine.cone().exterior_edges() > 0) add_cone(engine, rows, begin, end, values);
      if (diagnostics) bound_errors(engine, rows, begin, end, values, *diagnostics);
      if (done) done->fetch_add((end - begin) * rows.xs.size(), std::memory_order_relaxed);
    }
    on_surface += here;
  });
  return {sums.ties(), on_surface};
}

// The order of the triangles along the axis across which the block is a thin slab of the lattice, if it is.
std::optional<OrderedSlab> ordered_slab(const Engine& engine, const Lattice& lattice, const LatticeBlock& block) {
  constexpr std::int64_t kWorthSorting = 4;  // slabs
  if (engine.engine() != RayEngine::kScan) return std::nullopt;
  for (const int axis : {2, 1}) {
    const auto a = static_cast<std::size_t>(axis);
    if (block.counts[a] <= lattice.counts[a] / kWorthSorting) return OrderedSlab{engine.slab_order(axis), axis};
  }
  return std::nullopt;
}

// Points in an order in which neighbours share triangles: a radix sort by place that moves the points themselves, so
// that none has to be fetched from afar in the end.
class CoherentOrder {
 public:
  struct PlacedPoint {
    Vec3 point;
    std::uint32_t index;  // among the points
    std::uint16_t place;
  };
  static constexpr std::size_t kBuckets = 256;

  // Less than 2^32 points.
  CoherentOrder(const Engine& engine, std::span<const Vec3> points) : CoherentOrder(points, places(engine, points)) {}

  // Whether the engine can take all of the points.
  [[nodiscard]] bool all_taken() const { return all_taken_; }

  // Those of one bucket, in order.
  [[nodiscard]] std::vector<PlacedPoint> operator[](std::size_t bucket) const {
    std::array<std::uint32_t, kPlacesPerBucket + 1> next{};
    for (const PlacedPoint& p : buckets_[bucket]) ++next[p.place % kPlacesPerBucket + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<PlacedPoint> ordered(buckets_[bucket].size());
    for (const PlacedPoint& p : buckets_[bucket]) ordered[next[p.place % kPlacesPerBucket]++] = p;
    return ordered;
  }

 private:
  static constexpr std::size_t kPlacesPerBucket = ProjectedGrid::kPlaces / kBuckets;

  struct Places {
    std::vector<std::uint16_t> of_points;
    bool all_taken = true;
  };

  CoherentOrder(std::span<const Vec3> points, const Places& places)
      : all_taken_(places.all_taken),
        buckets_(points.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
          for (std::size_t i = begin; i < end; ++i) {
            const std::uint16_t place = places.of_points[i];
            emit(place / kPlacesPerBucket, PlacedPoint{points[i], static_cast<std::uint32_t>(i), place});
          }
        }) {}

  // Embree's rays go in the order of the points: they are for comparison.
  static Places places(const Engine& engine, std::span<const Vec3> points) {
    Places places;
    places.of_points.resize(points.size());
    std::atomic<bool> all_taken = true;
    constexpr std::size_t kPointsPerTask = 4096;
    parallel_for(points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
      bool taken = true;
      for (std::size_t i = begin; i < end; ++i) {
        taken = taken && engine.can_take(points[i]);
        places.of_points[i] = engine.engine() == RayEngine::kScan
                                  ? engine.grid().place(engine.to_scale(points[i]))
                                  : static_cast<std::uint16_t>(i / (points.size() / ProjectedGrid::kPlaces + 1));
      }
      if (!taken) all_taken = false;
    });
    places.all_taken = all_taken;
    return places;
  }

  bool all_taken_;
  Buckets<PlacedPoint> buckets_;
};

// Points that are evaluated together, and where their values belong.
class PointTile {
 public:
  [[nodiscard]] bool full() const { return points_.size() == kTile; }

  void add(std::size_t index, const Vec3& scaled_point) {
    indices_.push_back(index);
    points_.push_back(scaled_point);
  }

  // Evaluates the points, if any, and forgets them.
  Tally evaluate(const Engine& engine, std::span<double> values, const Diagnostics* diagnostics) {
    const std::span<double> here(values_.data(), points_.size());
    const Diagnostics diagnostics_here{{crossings_.data(), points_.size()},
                                       {degenerate_.data(), points_.size()},
                                       {on_surface_.data(), points_.size()},
                                       {error_bound_.data(), points_.size()}};
    const Tally tally = engine.evaluate_points(points_, here, diagnostics ? &diagnostics_here : nullptr, scratch_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      values[indices_[i]] = values_[i];
      if (!diagnostics) continue;
      diagnostics->crossings[indices_[i]] = crossings_[i];
      diagnostics->degenerate[indices_[i]] = degenerate_[i];
      diagnostics->on_surface[indices_[i]] = on_surface_[i];
      diagnostics->error_bound[indices_[i]] = error_bound_[i];
    }
    indices_.clear();
    points_.clear();
    return tally;
  }

 private:
  std::vector<std::size_t> indices_;
  std::vector<Vec3> points_;
  std::array<double, kTile> values_;
  std::array<std::int64_t, kTile> crossings_;
  std::array<std::int64_t, kTile> degenerate_;
  std::array<std::uint8_t, kTile> on_surface_;
  std::array<double, kTile> error_bound_;
  Scratch scratch_;
};

}  // namespace

// Whether the mesh has triangles; where it has none, all values are set to 0.
static bool has_values(const TriangleMesh& mesh, std::span<double> values, std::atomic<std::uint64_t>* done,
                       const Diagnostics* diagnostics) {
  if (!mesh.triangles.empty()) return true;
  std::ranges::fill(values, 0.0);
  if (done) done->fetch_add(values.size(), std::memory_order_relaxed);
  if (!diagnostics) return false;
  std::ranges::fill(diagnostics->crossings, 0);
  std::ranges::fill(diagnostics->degenerate, 0);
  std::ranges::fill(diagnostics->on_surface, std::uint8_t{0});
  std::ranges::fill(diagnostics->error_bound, 0.0);
  return false;
}

struct WindingNumberEvaluator::Implementation {
  Engine scaled;

  Implementation(TriangleMesh mesh, const PowerOfTwo& scale, RayEngine engine, SimdLevel level, Summation summation)
      : scaled(std::move(mesh), scale, engine, level, summation) {}

  // The engine for queries with these coordinates: where scaling would drop bits of one (a number below 1e-290 mesh
  // sizes), the mesh as it is, in which predicates are slower. A matter of each query alone, since the two may round
  // differently. Built when first needed.
  [[nodiscard]] const Engine& engine_for(bool scaling_is_exact) const {
    if (scaling_is_exact) return scaled;
    std::call_once(unscaled_built, [this] {
      unscaled.emplace(scaled.unscaled_mesh(), PowerOfTwo(0), scaled.engine(), scaled.level(), scaled.summation());
    });
    return *unscaled;
  }

  Tally evaluate_batch(std::span<const Vec3> points, std::span<double> values, std::atomic<std::uint64_t>* done,
                       const Diagnostics* diagnostics) const {
    // What the points need is built before the loops over them, within which threads would wait for one another.
    scaled.prepare_points();
    const CoherentOrder order(scaled, points);
    if (!order.all_taken()) engine_for(false).prepare_points();
    TallySum total;
    parallel_for(CoherentOrder::kBuckets, 1, [&](std::size_t begin, std::size_t end) {
      PointTile tile;
      Tally tally;
      for (std::size_t bucket = begin; bucket < end; ++bucket) {
        const auto placed = order[bucket];
        for (const CoherentOrder::PlacedPoint& p : placed) {
          const bool exact = order.all_taken() || scaled.can_take(p.point);
          if (!exact) tally += tile.evaluate(scaled, values, diagnostics);
          const Engine& engine = engine_for(exact);
          tile.add(p.index, engine.to_scale(p.point));
          if (!exact || tile.full()) tally += tile.evaluate(engine, values, diagnostics);
        }
        if (done) done->fetch_add(placed.size(), std::memory_order_relaxed);
      }
      tally += tile.evaluate(scaled, values, diagnostics);
      total.add(tally);
    });
    return total.sum();
  }

 private:
  mutable std::once_flag unscaled_built;
  mutable std::optional<Engine> unscaled;
};

WindingNumberEvaluator::WindingNumberEvaluator(TriangleMesh mesh, RayEngine engine, SimdLevel level,
                                               Summation summation) {
  check_counts(mesh);
  const DefaultFloatingPoint guard;
  const PowerOfTwo scale = unit_scale(mesh);
  implementation_ = std::make_unique<Implementation>(std::move(mesh), scale, engine, level, summation);
}
WindingNumberEvaluator::~WindingNumberEvaluator() = default;
WindingNumberEvaluator::WindingNumberEvaluator(WindingNumberEvaluator&&) noexcept = default;
WindingNumberEvaluator& WindingNumberEvaluator::operator=(WindingNumberEvaluator&&) noexcept = default;

std::uint64_t WindingNumberEvaluator::exterior_edges() const { return implementation_->scaled.cone().exterior_edges(); }

double WindingNumberEvaluator::doubt() const { return implementation_->scaled.doubt(); }

double WindingNumberEvaluator::accuracy() const {
  constexpr double u = 0x1p-53;
  return std::max(1e-10, u * implementation_->scaled.cone().total_multiplicity());
}

double WindingNumberEvaluator::settle(const Vec3& point, double value, double critical) const {
  if (exterior_edges() == 0) return value;
  const DefaultFloatingPoint guard;
  const Engine& engine = implementation_->engine_for(implementation_->scaled.can_take(point));
  return engine.cone().settle(engine.to_scale(point), value, critical);
}

void WindingNumberEvaluator::prepare_points() const {
  if (!implementation_->scaled.mesh().triangles.empty()) implementation_->scaled.prepare_points();
}

// Each part as a block of its own.
static Tally evaluate_parts(const WindingNumberEvaluator& evaluator, const Lattice& lattice, const LatticeBlock& block,
                            std::span<const LatticeBlock> parts, std::span<double> values,
                            std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) {
  Tally tally;
  for (const LatticeBlock& part : parts) {
    PartSamples samples(static_cast<std::size_t>(part.size()));
    tally += evaluator.evaluate(lattice, part, samples.values(), done, diagnostics ? &samples.diagnostics() : nullptr);
    samples.copy_to(block, part, values, diagnostics);
  }
  return tally;
}

Tally WindingNumberEvaluator::evaluate(const Lattice& lattice, const LatticeBlock& block, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  check_counts(block);
  assert(values.size() == static_cast<std::size_t>(block.size()));
  if (block.size() == 0) return {};
  if (!has_values(implementation_->scaled.mesh(), values, done, diagnostics)) return {};
  const DefaultFloatingPoint guard;  // scaling must not flush what is tiny
  const std::vector<LatticeBlock> parts =
      parts_alike(lattice, block, [this](double x) { return implementation_->scaled.can_take(x); });
  if (parts.size() != 1) return evaluate_parts(*this, lattice, block, parts, values, done, diagnostics);

  std::array<std::vector<double>, 3> coordinates;
  bool exact = true;  // on each axis for all or none
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::int64_t i = 0; i < block.counts[axis]; ++i) {
      coordinates[axis].push_back(lattice.coordinate(static_cast<int>(axis), block.first[axis] + i));
    }
    exact = exact && implementation_->scaled.can_take(coordinates[axis].front());
  }
  const Engine& engine = implementation_->engine_for(exact);
  if (engine.engine() == RayEngine::kEmbree) engine.prepare_points();
  const LatticeRows rows = rows_of(coordinates, engine);
  return evaluate_rows(engine, rows, ordered_slab(engine, lattice, block), values, done, diagnostics);
}

Tally WindingNumberEvaluator::evaluate(std::span<const Vec3> points, std::span<double> values,
                                       std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics) const {
  assert(values.size() == points.size());
  if (!has_values(implementation_->scaled.mesh(), values, done, diagnostics)) return {};
  const DefaultFloatingPoint guard;
  TallySum total;
  constexpr std::size_t kBatch = std::size_t{1} << 17;  // bounds the memory; points enough that neighbours are near
  for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, points.size() - begin);
    const Diagnostics of_batch = diagnostics ? part(*diagnostics, begin, count) : Diagnostics{};
    total.add(implementation_->evaluate_batch(points.subspan(begin, count), values.subspan(begin, count), done,
                                              diagnostics ? &of_batch : nullptr));
  }
  return total.sum();
}

}  // namespace raycone
