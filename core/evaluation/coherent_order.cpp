#include "core/evaluation/coherent_order.h"

#include <atomic>
#include <optional>
#include <utility>

#include "core/data/box.h"
#include "core/data/space_curve.h"
#include "core/machine/sorted_by_key.h"
#include "core/machine/threads.h"

namespace raycone {

CoherentOrder::CoherentOrder(std::span<const Vec3> points, const Keys& keys)
    : all_taken_(keys.all_taken),
      groups_(keys.groups),
      keys_per_bucket_(keys.count / kBuckets),
      buckets_(points.size(), kBuckets, [&](std::size_t begin, std::size_t end, auto emit) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t key = keys.of_points[i];
          emit(key / keys_per_bucket_, SortedPoint{points[i], static_cast<std::uint32_t>(i), key});
        }
      }) {}

CoherentOrder::Keys CoherentOrder::keys_of(const ScaledMesh& mesh, std::span<const Vec3> points) {
  const BlocksOfPoints* const blocks = mesh.blocks_of_points();
  return blocks ? keys_in_blocks(mesh, blocks->sums, points) : keys_along_curves(mesh, points);
}

CoherentOrder::Keys CoherentOrder::keys_in_blocks(const ScaledMesh& mesh, const PointBlocks& blocks,
                                                  std::span<const Vec3> points) {
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
CoherentOrder::Keys CoherentOrder::keys_along_curves(const ScaledMesh& mesh, std::span<const Vec3> points) {
  const ProjectedGrid* const grid = mesh.has_far_field() ? nullptr : mesh.grid_if_built();
  constexpr std::size_t kFew = 4096;
  const unsigned bits = points.size() > kFew ? 7 : 4;  // of each axis; all places are gone through
  Keys keys{!grid ? 1U << (3 * bits) : std::uint32_t{ProjectedGrid::kMortonCodes}, {}, true, {}};
  keys.of_points.resize(points.size());
  std::atomic<bool> all_taken = true;
  const SpaceCurve curve(!grid ? mesh.box() : empty_box(), bits);
  const auto key_of = [&](const Vec3& q) -> std::uint32_t {
    return grid ? grid->morton_code(q) : static_cast<std::uint32_t>(curve.place(q));
  };
  constexpr std::size_t kPointsPerTask = 4096;
  parallel_for(points.size(), kPointsPerTask, [&](std::size_t begin, std::size_t end) {
    bool taken = true;
    for (std::size_t i = begin; i < end; ++i) {
      taken = taken && mesh.can_take(points[i]);
      keys.of_points[i] = mesh.options().ray_engine != RayEngine::kEmbree
                              ? key_of(mesh.to_scale(points[i]))
                              : static_cast<std::uint32_t>(i / (points.size() / keys.count + 1));
    }
    if (!taken) all_taken = false;
  });
  keys.all_taken = all_taken;
  return keys;
}

std::vector<CoherentOrder::SortedPoint> CoherentOrder::operator[](std::size_t bucket) const {
  SortedByKey<SortedPoint, std::uint32_t> sorted(keys_per_bucket_, [&](const auto& emit) {
    for (const SortedPoint& p : buckets_[bucket]) emit(p.key % keys_per_bucket_, p);
  });
  return std::move(sorted).release();
}

}  // namespace raycone
