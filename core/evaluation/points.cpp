#include "core/evaluation/points.h"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <numeric>
#include <vector>

#include "core/machine/buckets.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Diagnostics of the samples [begin, begin + count).
Diagnostics part(const Diagnostics& all, std::size_t begin, std::size_t count) {
  return {all.crossings.subspan(begin, count), all.degenerate.subspan(begin, count),
          all.on_surface.subspan(begin, count), all.error_bound.subspan(begin, count)};
}

// A curve through a box that fills it: neighbours on it are neighbours in space.
class SpaceCurve {
 public:
  explicit SpaceCurve(const TriangleMesh& mesh) : box_(bounding_box(mesh)) {
    const Vec3 size = box_.upper - box_.lower;
    cells_per_unit_ = kCells / std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()});
  }
  [[nodiscard]] std::uint32_t code(const Vec3& q) const {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double offset = (q[axis] - box_.lower[axis]) * cells_per_unit_;
      const auto cell = static_cast<unsigned>(std::min(std::max(0.0, offset), kCells - 1));  // NaN: 0
      for (unsigned bit = 0; bit < kBits; ++bit) code |= (cell >> bit & 1U) << (3 * bit + static_cast<unsigned>(axis));
    }
    return code;
  }
  static constexpr std::uint32_t codes() { return 1U << (3 * kBits); }

 private:
  static constexpr unsigned kBits = 7;
  static constexpr double kCells = 1U << kBits;
  Box box_;
  double cells_per_unit_;
};

// A radix sort by position along a curve, through the projections or through space, that moves the points themselves,
// so that none has to be fetched from afar in the end.
class CoherentOrder {
 public:
  struct SortedPoint {
    Vec3 point;
    std::uint32_t index;  // among the points
    std::uint32_t key;
  };
  static constexpr std::size_t kBuckets = 256;

  // Less than 2^32 points.
  CoherentOrder(const ScaledMesh& mesh, std::span<const Vec3> points) : CoherentOrder(points, keys_of(mesh, points)) {}

  // How many points are put in order together: enough that neighbours are near, few enough that they take little
  // memory. Around a far field that pays more: the nearer neighbours are, the more nodes they share.
  static std::size_t batch(const ScaledMesh& mesh) { return std::size_t{1} << (mesh.has_far_field() ? 19 : 17); }

  // Whether the mesh can take all of the points.
  [[nodiscard]] bool all_taken() const { return all_taken_; }

  // Those of one bucket, in order.
  [[nodiscard]] std::vector<SortedPoint> operator[](std::size_t bucket) const {
    std::vector<std::uint32_t> next(keys_per_bucket_ + 1);
    for (const SortedPoint& p : buckets_[bucket]) ++next[p.key % keys_per_bucket_ + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<SortedPoint> ordered(buckets_[bucket].size());
    for (const SortedPoint& p : buckets_[bucket]) ordered[next[p.key % keys_per_bucket_]++] = p;
    return ordered;
  }

 private:
  struct Keys {
    std::uint32_t count;  // of those there can be
    std::vector<std::uint32_t> of_points;
    bool all_taken = true;
  };

  CoherentOrder(std::span<const Vec3> points, const Keys& keys)
      : all_taken_(keys.all_taken),
        keys_per_bucket_(keys.count / kBuckets),
        buckets_(points.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
          for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t key = keys.of_points[i];
            emit(key / keys_per_bucket_, SortedPoint{points[i], static_cast<std::uint32_t>(i), key});
          }
        }) {}

  // Embree's rays go in the order of the points: they are for comparison.
  static Keys keys_of(const ScaledMesh& mesh, std::span<const Vec3> points) {
    const bool far = mesh.has_far_field();
    Keys keys{far ? SpaceCurve::codes() : std::uint32_t{ProjectedGrid::kMortonCodes}, {}};
    keys.of_points.resize(points.size());
    std::atomic<bool> all_taken = true;
    const SpaceCurve curve(mesh.mesh());
    const auto key_of = [&](const Vec3& q) -> std::uint32_t {
      return far ? curve.code(q) : mesh.grid().morton_code(q);
    };
    constexpr std::size_t kPointsPerTask = 4096;
    parallel_for(points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
      bool taken = true;
      for (std::size_t i = begin; i < end; ++i) {
        taken = taken && mesh.can_take(points[i]);
        keys.of_points[i] = mesh.options().ray_engine == RayEngine::kScan
                                ? key_of(mesh.to_scale(points[i]))
                                : static_cast<std::uint32_t>(i / (points.size() / keys.count + 1));
      }
      if (!taken) all_taken = false;
    });
    keys.all_taken = all_taken;
    return keys;
  }

  bool all_taken_;
  std::size_t keys_per_bucket_;
  Buckets<SortedPoint> buckets_;
};

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

// Points that are evaluated together, and where their values belong.
class PointTile {
 public:
  explicit PointTile(ScaledMesh::Settling settling) : settling_(settling) {}

  [[nodiscard]] bool full() const { return samples_.count == kTile; }

  void add(std::size_t index, const Vec3& scaled_point) {
    indices_[samples_.count] = index;
    samples_.add(scaled_point);
  }

  // Evaluates the points, if any, and forgets them.
  Tally evaluate(const ScaledMesh& mesh, std::span<double> values, const Diagnostics* diagnostics) {
    Tally tally;
    if (samples_.count == 0) return tally;
    std::array<std::int64_t, kTile> n;
    std::array<double, kTile> w;
    for (std::size_t i = 0; i < samples_.count; ++i) {
      const PointCrossings crossings = crossings_at(mesh, samples_.query(i));
      n[i] = crossings.n;
      tally += {static_cast<std::uint64_t>(crossings.ties), crossings.on_surface ? 1U : 0U};
      if (!diagnostics) continue;
      diagnostics->crossings[indices_[i]] = crossings.n;
      diagnostics->degenerate[indices_[i]] = crossings.ties;
      diagnostics->on_surface[indices_[i]] = crossings.on_surface ? 1 : 0;
    }
    mesh.set_values(samples_, {n.data(), samples_.count}, {w.data(), samples_.count}, settling_);
    for (std::size_t i = 0; i < samples_.count; ++i) {
      values[indices_[i]] = w[i];
      if (diagnostics) diagnostics->error_bound[indices_[i]] = mesh.error_bound(samples_.query(i), w[i], n[i]);
    }
    samples_.clear();
    return tally;
  }

 private:
  PointCrossings crossings_at(const ScaledMesh& mesh, const Vec3& q) {
    PointCrossings result;
    const auto decide = [&](std::uint32_t triangle) { result.add(mesh.crossing(triangle, {q.y, q.z, {&q.x, 1}})); };
    if (mesh.options().ray_engine == RayEngine::kScan) {
      result.n += mesh.grid().crossings(q, decide);
    } else {
      mesh.rays().find_candidates(q, candidates_);
      for (const std::uint32_t triangle : candidates_) decide(triangle);
    }
    return result;
  }

  ScaledMesh::Settling settling_;
  std::array<std::size_t, kTile> indices_;
  SampleTile samples_;
  std::vector<std::uint32_t> candidates_;
};

// Some of the points, at most as many as CoherentOrder takes.
Tally evaluate_batch(const ScaledMeshes& meshes, std::span<const Vec3> points, std::span<double> values,
                     std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics, ScaledMesh::Settling settling) {
  const ScaledMesh& scaled = meshes.scaled();
  // What the points need is built before the loops over them, within which threads would wait for one another.
  scaled.prepare_points();
  const CoherentOrder order(scaled, points);
  if (!order.all_taken()) meshes.unscaled().prepare_points();
  std::mutex mutex;
  Tally total;
  parallel_for(CoherentOrder::kBuckets, 1, [&](std::size_t begin, std::size_t end) {
    PointTile tile(settling);
    Tally tally;
    for (std::size_t bucket = begin; bucket < end; ++bucket) {
      const auto sorted = order[bucket];
      for (const CoherentOrder::SortedPoint& p : sorted) {
        const bool exact = order.all_taken() || scaled.can_take(p.point);
        if (!exact) tally += tile.evaluate(scaled, values, diagnostics);
        const ScaledMesh& mesh = meshes.of_query(exact);
        tile.add(p.index, mesh.to_scale(p.point));
        if (!exact || tile.full()) tally += tile.evaluate(mesh, values, diagnostics);
      }
      if (done) done->fetch_add(sorted.size(), std::memory_order_relaxed);
    }
    tally += tile.evaluate(scaled, values, diagnostics);
    const std::lock_guard<std::mutex> lock(mutex);
    total += tally;  // integers: their order does not matter
  });
  return total;
}

}  // namespace

Tally evaluate_points(const ScaledMeshes& meshes, std::span<const Vec3> points, std::span<double> values,
                      std::atomic<std::uint64_t>* done, const Diagnostics* diagnostics, ScaledMesh::Settling settling) {
  Tally total;
  const std::size_t batch = CoherentOrder::batch(meshes.scaled());
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t count = std::min(batch, points.size() - begin);
    const Diagnostics of_batch = diagnostics ? part(*diagnostics, begin, count) : Diagnostics{};
    total += evaluate_batch(meshes, points.subspan(begin, count), values.subspan(begin, count), done,
                            diagnostics ? &of_batch : nullptr, settling);
  }
  return total;
}

}  // namespace raycone
