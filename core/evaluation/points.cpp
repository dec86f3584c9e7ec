#include "core/evaluation/points.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/evaluation/coherent_order.h"
#include "core/evaluation/meeting_rays.h"
#include "core/evaluation/point_crossings.h"
#include "core/evaluation/point_tile.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// The crossings, by a pass over the triangles, of those of the points point_at(n), n < count, that are to be had. None
// where the mesh has another way to find them.
template <class PointAt, class IsToBeHad>
std::optional<PointCrossings> crossings_without_grid(const ScaledMesh& mesh, std::size_t count, const PointAt& point_at,
                                                     const IsToBeHad& is_to_be_had) {
  if (!takes_passes(mesh)) return std::nullopt;
  std::vector<NumberedRay> rays;
  rays.reserve(count);
  for (std::uint32_t n = 0; n < count; ++n) {
    const Vec3 q = point_at(n);
    if (is_to_be_had(q)) rays.push_back({mesh.to_scale(q), n});
  }
  return crossings_by_pass(mesh, std::move(rays), count);
}

// --- Closed meshes that have a grid ---------------------------------------------------------------------------------

void set_to_zero(std::size_t begin, std::size_t end, std::span<double> values, const Diagnostics* diagnostics) {
  const std::size_t count = end - begin;
  std::ranges::fill(values.subspan(begin, count), 0.0);
  if (diagnostics) diagnostics->part(begin, count).set_to_zero();
}

// Those from order[begin] to before order[end]; places in the order are the numbers of their rays.
Tally evaluate_in_order(const ScaledMesh& mesh, std::span<const Vec3> points, std::span<const std::uint32_t> order,
                        std::size_t begin, std::size_t end, PointTile& tile) {
  constexpr std::size_t kAhead = 24;  // points that are fetched meanwhile
  Tally tally;
  for (std::size_t n = begin; n < end; ++n) {
    const Vec3& later = points[order[std::min(n + kAhead, order.size() - 1)]];
    __builtin_prefetch(&later);
    tile.add(order[n], mesh.to_scale(points[order[n]]), n);
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

// On all threads.
Tally evaluate_all_in_order(const ScaledMesh& mesh, std::span<const Vec3> points, std::span<const std::uint32_t> order,
                            const ValueOutputs& out, ScaledMesh::Settling settling) {
  constexpr std::size_t kTogether = std::size_t{1} << 16, kPointsPerTask = 4096;
  SharedTally tally;
  mesh.prepare_points(static_cast<double>(order.size()));
  for (std::size_t first = 0, count = 0; first < order.size(); first += count) {
    count = std::min(kTogether, order.size() - first);
    const std::span<const std::uint32_t> batch = order.subspan(first, count);
    const auto crossings = crossings_without_grid(
        mesh, count, [&](std::size_t n) { return points[batch[n]]; }, [](const Vec3&) { return true; });
    parallel_for(count, kPointsPerTask, [&](std::size_t begin, std::size_t end) {
      PointTile tile(out.values, out.diagnostics, settling, crossings ? &*crossings : nullptr);
      tally.add(evaluate_in_order(mesh, points, batch, begin, end, tile));
      out.count_done(end - begin);
    });
  }
  return tally.total();
}

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
  const std::size_t size = points_of_a_part(points.size());
  std::vector<std::vector<std::uint32_t>> others((points.size() + size - 1) / size);
  SharedTally tally;
  parallel_for(others.size(), 1, [&](std::size_t first, std::size_t last) {
    PointTile tile(out.values, out.diagnostics, settling);
    for (std::size_t part = first; part < last; ++part) {
      const std::size_t begin = part * size, end = std::min(begin + size, points.size());
      set_to_zero(begin, end, out.values, out.diagnostics);
      const MeetingRays rays(scaled, points, begin, end);
      tally.add(evaluate_in_order(scaled, points, rays.ordered(), 0, rays.ordered().size(), tile));
      others[part].assign(rays.others().begin(), rays.others().end());
      out.count_done(end - begin - others[part].size());
    }
  });
  std::vector<std::uint32_t> all_others;
  for (const auto& part : others) all_others.insert(all_others.end(), part.begin(), part.end());
  Tally of_all = tally.total();
  if (!all_others.empty()) of_all += evaluate_all_in_order(meshes.unscaled(), points, all_others, out, settling);
  return of_all;
}

// --- All meshes -----------------------------------------------------------------------------------------------------

// What the rays of a batch cross, where a pass over the triangles has told: of the points that the scaled mesh takes,
// and of the others. By the points' numbers.
struct BatchCrossings {
  std::optional<PointCrossings> scaled, unscaled;

  BatchCrossings(const ScaledMeshes& meshes, std::span<const Vec3> points, bool all_taken) {
    const auto point_at = [&](std::size_t n) { return points[n]; };
    const auto taken = [&](const Vec3& q) { return all_taken || meshes.scaled().can_take(q); };
    scaled = crossings_without_grid(meshes.scaled(), points.size(), point_at, taken);
    if (all_taken) return;
    meshes.unscaled().prepare_points(static_cast<double>(std::ranges::count_if(points, std::not_fn(taken))));
    unscaled = crossings_without_grid(meshes.unscaled(), points.size(), point_at, std::not_fn(taken));
  }
};

// Points of a thread that are to be evaluated, by the mesh that takes them.
struct Tiles {
  PointTile scaled, unscaled;

  Tiles(const ValueOutputs& out, ScaledMesh::Settling settling, const BatchCrossings& crossings)
      : scaled(out.values, out.diagnostics, settling, crossings.scaled ? &*crossings.scaled : nullptr),
        unscaled(out.values, out.diagnostics, settling, crossings.unscaled ? &*crossings.unscaled : nullptr) {}
};

// What evaluates the points of a batch.
class BatchEvaluation {
 public:
  BatchEvaluation(const ScaledMeshes& meshes, const CoherentOrder& order) : meshes_(meshes), order_(order) {}

  // Points of no blocks.
  Tally evaluate(std::span<const CoherentOrder::SortedPoint> points, Tiles& tiles) const {
    Tally tally;
    for (const CoherentOrder::SortedPoint& p : points) {
      const bool exact = order_.all_taken() || meshes_.scaled().can_take(p.point);
      const ScaledMesh& mesh = meshes_.of_query(exact);
      PointTile& tile = exact ? tiles.scaled : tiles.unscaled;
      tile.add(p.index, mesh.to_scale(p.point), p.index);
      if (tile.full()) tally += tile.evaluate(mesh);
    }
    return tally;
  }

  // In blocks of points, group by group.
  Tally evaluate_groups(const PointBlocks& blocks, std::span<const CoherentOrder::SortedPoint> points,
                        Tiles& tiles) const {
    const ScaledMesh& scaled = meshes_.scaled();
    Tally tally;
    for (auto begin = points.begin(), end = begin; begin != points.end(); begin = end) {
      const std::uint32_t key = begin->key;
      end = std::find_if(begin, points.end(), [&](const auto& p) { return p.key != key; });
      if (key == CoherentOrder::kOutside) {
        tally += evaluate({begin, end}, tiles);
        tally += tiles.scaled.evaluate(scaled);
        continue;
      }
      PointBlocks::Sums sums(blocks, key - 1);
      for (const CoherentOrder::SortedPoint& p : std::span(begin, end)) {
        tiles.scaled.add(p.index, scaled.to_scale(p.point), p.index);
        if (tiles.scaled.full()) tally += tiles.scaled.evaluate(scaled, &sums);
      }
      tally += tiles.scaled.evaluate(scaled, &sums);
    }
    return tally;
  }

  // What is left in the tiles.
  Tally finish(Tiles& tiles) const {
    Tally tally = tiles.scaled.evaluate(meshes_.scaled());
    if (!order_.all_taken()) tally += tiles.unscaled.evaluate(meshes_.unscaled());
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
  const CoherentOrder order(scaled, points);
  const BlocksOfPoints* const blocks = scaled.blocks_of_points();
  if (blocks) blocks->sums.prepare(order.groups());
  const BatchCrossings crossings(meshes, points, order.all_taken());
  const BatchEvaluation batch(meshes, order);
  SharedTally total;
  parallel_for(CoherentOrder::kBuckets, buckets_of_a_part(points.size()), [&](std::size_t begin, std::size_t end) {
    Tiles tiles(out, settling, crossings);
    Tally tally;
    for (std::size_t bucket = begin; bucket < end; ++bucket) {
      const auto sorted = order[bucket];
      tally += blocks ? batch.evaluate_groups(blocks->sums, sorted, tiles) : batch.evaluate(sorted, tiles);
      out.count_done(sorted.size());
    }
    tally += batch.finish(tiles);
    total.add(tally);
  });
  return total.total();
}

}  // namespace

Tally evaluate_points(const ScaledMeshes& meshes, std::span<const Vec3> points, const ValueOutputs& out,
                      ScaledMesh::Settling settling) {
  Tally total;
  const ScaledMesh& scaled = meshes.scaled();
  constexpr std::size_t kIndexable = std::size_t{1} << 31;
  for (std::size_t begin = 0, count = 0; begin < points.size(); begin += count) {
    const std::size_t left = points.size() - begin;
    // What the points need is built before the loops over them, within which threads would wait for one another.
    scaled.prepare_points(static_cast<double>(left));
    const bool closed = scaled.is_closed() && scaled.grid_if_built() != nullptr;
    count = std::min(closed ? kIndexable : CoherentOrder::batch(scaled), left);
    if (takes_passes(scaled)) count = scaled.grid_choice().points_to_try(count);
    const Diagnostics diagnostics = out.diagnostics ? out.diagnostics->part(begin, count) : Diagnostics{};
    const ValueOutputs of_batch{out.values.subspan(begin, count), out.done, out.diagnostics ? &diagnostics : nullptr};
    total += (closed ? evaluate_closed : evaluate_batch)(meshes, points.subspan(begin, count), of_batch, settling);
  }
  return total;
}

}  // namespace raycone
