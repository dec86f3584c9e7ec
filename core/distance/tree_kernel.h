// Searches of a DistanceTree in SIMD lanes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/distance/distance_tree.h"

namespace raycone {

// DistanceTree::squared_distance().
using NearestSearch = double (*)(const DistanceTree& tree, const Vec3& p, double limit);
// DistanceTree::find_packs().
using PackSearch = void (*)(const DistanceTree& tree, const Box& box, double limit, std::size_t most,
                            std::vector<std::uint32_t>& found);
// The slots of triangles whose squared distance from p is `square`, which is that of none of them less: a bit for each.
using SlotSearch = std::uint32_t (*)(const TrianglePack& pack, const Vec3& p, double square);

// Those of the level, of the best one where the level is not available. Results are the same for every level.
[[nodiscard]] NearestSearch nearest_search(SimdLevel level);
[[nodiscard]] PackSearch pack_search(SimdLevel level);
[[nodiscard]] SlotSearch slot_search(SimdLevel level);

}  // namespace raycone
