#include "core/evaluation/points.h"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include "core/data/space_curve.h"
#include "core/evaluation/point_tile.h"
#include "core/machine/buckets.h"
#include "core/machine/sorted_by_key.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

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
  static std::size_t batch(const ScaledMesh& mesh) {
    return std::size_t{1} << (mesh.blocks_of_points() || mesh.has_far_field() ? 19 : 17);
  }

  // Of points outside of the blocks of points, where the mesh has them; in the others the key is that of the group + 1.
  static constexpr std::uint32_t kOutside = 0;

  // Whether the mesh can take all of the points.
  [[nodiscard]] bool all_taken() const { return all_taken_; }
  // Of points in blocks of points.
  [[nodiscard]] std::span<const std::uint32_t> groups() const { return groups_; }

  // Those of one bucket, in order.
  [[nodiscard]] std::vector<SortedPoint> operator[](std::size_t bucket) const {
    SortedByKey<SortedPoint, std::uint32_t> sorted(keys_per_bucket_, [&](const auto& emit) {
      for (const SortedPoint& p : buckets_[bucket]) emit(p.key % keys_per_bucket_, p);
    });
    return std::move(sorted).release();
  }

 private:
  struct Keys {
    std::uint32_t count;  // of those there can be
    std::vector<std::uint32_t> of_points;
    bool all_taken = true;
    std::vector<std::uint32_t> groups;
  };

  CoherentOrder(std::span<const Vec3> points, const Keys& keys)
      : all_taken_(keys.all_taken),
        groups_(keys.groups),
        keys_per_bucket_(keys.count / kBuckets),
        buckets_(points.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
          for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t key = keys.of_points[i];
            emit(key / keys_per_bucket_, SortedPoint{points[i], static_cast<std::uint32_t>(i), key});
          }
        }) {}

  static Keys keys_of(const ScaledMesh& mesh, std::span<const Vec3> points) {
    const BlocksOfPoints* const blocks = mesh.blocks_of_points();
    return blocks ? keys_in_blocks(mesh, blocks->sums, points) : keys_along_curves(mesh, points);
  }

  static Keys keys_in_blocks(const ScaledMesh& mesh, const PointBlocks& blocks, std::span<const Vec3> points) {
    Keys keys{(blocks.groups() / std::uint32_t{kBuckets} + 1) * std::uint32_t{kBuckets}, {}, true, {}};
    keys.of_points.resize(points.size());
    std::atomic<bool> all_taken = true;
    constexpr std::size_t kPointsPerTask = 4096;
    parallel_for_each(points.size(), kPointsPerTask, [&](std::size_t i) {
      const bool taken = mesh.can_take(points[i]);
      if (!taken) all_taken = false;
      const auto group = taken ? blocks.group_of(mesh.to_scale(points[i])) : std::nullopt;
      keys.of_points[i] = group ? *group + 1 : kOutside;
    });
    keys.all_taken = all_taken;
    std::vector<std::uint8_t> used(std::size_t{blocks.groups()} + 1);
    for (const std::uint32_t key : keys.of_points) used[key] = 1;
    for (std::uint32_t group = 0; group < blocks.groups(); ++group) {
      if (used[group + 1]) keys.groups.push_back(group);
    }
    return keys;
  }

  // Embree's rays go in the order of the points: they are for comparison.
  static Keys keys_along_curves(const ScaledMesh& mesh, std::span<const Vec3> points) {
    const bool far = mesh.has_far_field();
    constexpr unsigned kBits = 7;  // of each axis
    Keys keys{far ? 1U << (3 * kBits) : std::uint32_t{ProjectedGrid::kMortonCodes}, {}, true, {}};
    keys.of_points.resize(points.size());
    std::atomic<bool> all_taken = true;
    const SpaceCurve curve(far ? bounding_box(mesh.mesh()) : empty_box(), kBits);
    const auto key_of = [&](const Vec3& q) -> std::uint32_t {
      return far ? static_cast<std::uint32_t>(curve.place(q)) : mesh.grid().morton_code(q);
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
  std::vector<std::uint32_t> groups_;
  std::size_t keys_per_bucket_;
  Buckets<SortedPoint> buckets_;
};

// ---- Closed meshes ---------------------------------------------------------------------------------------------

// Points of a closed mesh whose rays may meet it, in an order in which neighbours share triangles.
class MeetingRays {
 public:
  // Of the points [begin, end).
  MeetingRays(const ScaledMesh& mesh, std::span<const Vec3> points, std::size_t begin, std::size_t end)
      : buckets_(end - begin), indices_(end - begin) {
    for (std::size_t first = begin; first < end; first += kTile) {
      add(mesh, points.subspan(first, std::min(kTile, end - first)), static_cast<std::uint32_t>(first));
    }
    std::partial_sum(next_.begin(), next_.end(), next_.begin());
    ordered_.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) ordered_[next_[buckets_[i]]++] = indices_[i];
  }

  [[nodiscard]] std::span<const std::uint32_t> ordered() const { return ordered_; }

  // Those that scaling would change. They are not among the ordered ones.
  [[nodiscard]] std::span<const std::uint32_t> others() const { return others_; }

 private:
  // At most kTile, of which the first one has that index.
  void add(const ScaledMesh& mesh, std::span<const Vec3> points, std::uint32_t first) {
    std::array<Vec3, kTile> queries;
    std::array<ProjectedGrid::Place, kTile> places;
    for (std::size_t i = 0; i < points.size(); ++i) queries[i] = mesh.to_scale(points[i]);
    mesh.grid().find_places({queries.data(), points.size()}, {places.data(), points.size()});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint32_t index = first + static_cast<std::uint32_t>(i);
      const bool is_other = !mesh.can_take(points[i]);
      if (is_other) others_.push_back(index);
      const std::uint32_t is_next = places[i].may_meet && !is_other ? 1 : 0;
      const auto bucket = static_cast<std::uint8_t>(places[i].morton_code / kCodesPerBucket);
      buckets_[count_] = bucket;
      indices_[count_] = index;
      next_[bucket + std::size_t{1}] += is_next;
      count_ += is_next;
    }
  }

  static constexpr std::size_t kBuckets = 256, kCodesPerBucket = ProjectedGrid::kMortonCodes / kBuckets;
  std::size_t count_ = 0;
  std::vector<std::uint8_t> buckets_;
  std::vector<std::uint32_t> indices_, ordered_, others_;
  std::array<std::uint32_t, kBuckets + 1> next_{};
};

void set_to_zero(std::size_t begin, std::size_t end, std::span<double> values, const Diagnostics* diagnostics) {
  const std::size_t count = end - begin;
  std::ranges::fill(values.subspan(begin, count), 0.0);
  if (diagnostics) diagnostics->part(begin, count).set_to_zero();
}

Tally evaluate_in_order(const ScaledMesh& mesh, std::span<const Vec3> points, std::span<const std::uint32_t> order,
                        PointTile& tile) {
  constexpr std::size_t kAhead = 24;  // points that are fetched meanwhile
  Tally tally;
  for (std::size_t n = 0; n < order.size(); ++n) {
    const Vec3& later = points[order[std::min(n + kAhead, order.size() - 1)]];
    __builtin_prefetch(&later);
    tile.add(order[n], mesh.to_scale(points[order[n]]));
    if (tile.full()) tally += tile.evaluate(mesh);
  }
  return tally += tile.evaluate(mesh);
}

// Adds up what threads have counted: integers, so that their order does not matter.
class SharedTally {
 public:
  void add(const Tally& tally) {
    const std::lock_guard<std::mutex> lock(mutex_);
    total_ += tally;
  }
  [[nodiscard]] const Tally& total() const { return total_; }

 private:
  std::mutex mutex_;
  Tally total_;
};

// How many points one thread puts in order together: many, so that neighbours are near, but some for each thread.
std::size_t points_of_a_part(std::size_t points) {
  constexpr std::size_t kLeast = 4096, kMost = std::size_t{1} << 16, kPartsPerThread = 8;
  return std::clamp(points / (kPartsPerThread * static_cast<std::size_t>(thread_count())), kLeast, kMost);
}

// Of less than 2^32 points. Many rays meet nothing: their values are 0. The others are put in order, some at a time,
// each thread for itself.
Tally evaluate_closed(const ScaledMeshes& meshes, std::span<const Vec3> points, const ValueOutputs& out,
                      ScaledMesh::Settling settling) {
  const ScaledMesh& scaled = meshes.scaled();
  // What the points need is built before the loops over them, within which threads would wait for one another.
  scaled.prepare_points();
  const std::size_t size = points_of_a_part(points.size());
  std::vector<std::vector<std::uint32_t>> others((points.size() + size - 1) / size);
  SharedTally tally;
  parallel_for(others.size(), 1, [&](std::size_t first, std::size_t last) {
    PointTile tile(out.values, out.diagnostics, settling);
    for (std::size_t part = first; part < last; ++part) {
      const std::size_t begin = part * size, end = std::min(begin + size, points.size());
      set_to_zero(begin, end, out.values, out.diagnostics);
      const MeetingRays rays(scaled, points, begin, end);
      tally.add(evaluate_in_order(scaled, points, rays.ordered(), tile));
      others[part].assign(rays.others().begin(), rays.others().end());
      out.count_done(end - begin - others[part].size());
    }
  });
  const bool all_taken = std::ranges::all_of(others, [](const auto& part) { return part.empty(); });
  if (all_taken) return tally.total();
  const ScaledMesh& unscaled = meshes.unscaled();
  unscaled.prepare_points();
  parallel_for(others.size(), 1, [&](std::size_t first, std::size_t last) {
    PointTile tile(out.values, out.diagnostics, settling);
    for (std::size_t part = first; part < last; ++part) {
      tally.add(evaluate_in_order(unscaled, points, others[part], tile));
      out.count_done(others[part].size());
    }
  });
  return tally.total();
}

// ---- All meshes ------------------------------------------------------------------------------------------------

// What evaluates the points of a batch.
class BatchEvaluation {
 public:
  BatchEvaluation(const ScaledMeshes& meshes, const CoherentOrder& order) : meshes_(meshes), order_(order) {}

  // Points of no blocks.
  Tally evaluate(std::span<const CoherentOrder::SortedPoint> points, PointTile& tile) const {
    const ScaledMesh& scaled = meshes_.scaled();
    Tally tally;
    for (const CoherentOrder::SortedPoint& p : points) {
      const bool exact = order_.all_taken() || scaled.can_take(p.point);
      if (!exact) tally += tile.evaluate(scaled);
      const ScaledMesh& mesh = meshes_.of_query(exact);
      tile.add(p.index, mesh.to_scale(p.point));
      if (!exact || tile.full()) tally += tile.evaluate(mesh);
    }
    return tally;
  }

  // In blocks of points, group by group.
  Tally evaluate_groups(const PointBlocks& blocks, std::span<const CoherentOrder::SortedPoint> points,
                        PointTile& tile) const {
    const ScaledMesh& scaled = meshes_.scaled();
    Tally tally;
    for (auto begin = points.begin(), end = begin; begin != points.end(); begin = end) {
      const std::uint32_t key = begin->key;
      end = std::find_if(begin, points.end(), [&](const auto& p) { return p.key != key; });
      if (key == CoherentOrder::kOutside) {
        tally += evaluate({begin, end}, tile);
        tally += tile.evaluate(scaled);
        continue;
      }
      PointBlocks::Sums sums(blocks, key - 1);
      for (const CoherentOrder::SortedPoint& p : std::span(begin, end)) {
        tile.add(p.index, scaled.to_scale(p.point));
        if (tile.full()) tally += tile.evaluate(scaled, &sums);
      }
      tally += tile.evaluate(scaled, &sums);
    }
    return tally;
  }

 private:
  const ScaledMeshes& meshes_;
  const CoherentOrder& order_;
};

// How many buckets of these points one thread takes at once: enough that tiles are full, if each thread has a few
// points.
std::size_t buckets_of_a_part(std::size_t points) {
  constexpr std::size_t kFew = 8;
  const std::size_t parts = std::max(points / kTile, std::min(static_cast<std::size_t>(thread_count()), points / kFew));
  return CoherentOrder::kBuckets / std::clamp<std::size_t>(parts, 1, CoherentOrder::kBuckets);
}

// Some of the points, at most as many as CoherentOrder takes.
Tally evaluate_batch(const ScaledMeshes& meshes, std::span<const Vec3> points, const ValueOutputs& out,
                     ScaledMesh::Settling settling) {
  const ScaledMesh& scaled = meshes.scaled();
  // What the points need is built before the loops over them, within which threads would wait for one another.
  scaled.prepare_points();
  const CoherentOrder order(scaled, points);
  if (!order.all_taken()) meshes.unscaled().prepare_points();
  const BlocksOfPoints* const blocks = scaled.blocks_of_points();
  if (blocks) blocks->sums.prepare(order.groups());
  const BatchEvaluation batch(meshes, order);
  SharedTally total;
  parallel_for(CoherentOrder::kBuckets, buckets_of_a_part(points.size()), [&](std::size_t begin, std::size_t end) {
    PointTile tile(out.values, out.diagnostics, settling);
    Tally tally;
    for (std::size_t bucket = begin; bucket < end; ++bucket) {
      const auto sorted = order[bucket];
      tally += blocks ? batch.evaluate_groups(blocks->sums, sorted, tile) : batch.evaluate(sorted, tile);
      out.count_done(sorted.size());
    }
    tally += tile.evaluate(scaled);
    total.add(tally);
  });
  return total.total();
}

}  // namespace

Tally evaluate_points(const ScaledMeshes& meshes, std::span<const Vec3> points, const ValueOutputs& out,
                      ScaledMesh::Settling settling) {
  Tally total;
  const ScaledMesh& scaled = meshes.scaled();
  const bool closed = scaled.is_closed() && scaled.options().ray_engine == RayEngine::kScan;
  constexpr std::size_t kIndexable = std::size_t{1} << 31;
  const std::size_t batch = closed ? kIndexable : CoherentOrder::batch(scaled);
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t count = std::min(batch, points.size() - begin);
    const Diagnostics diagnostics = out.diagnostics ? out.diagnostics->part(begin, count) : Diagnostics{};
    const ValueOutputs of_batch{out.values.subspan(begin, count), out.done, out.diagnostics ? &diagnostics : nullptr};
    total += (closed ? evaluate_closed : evaluate_batch)(meshes, points.subspan(begin, count), of_batch, settling);
  }
  return total;
}

}  // namespace raycone
