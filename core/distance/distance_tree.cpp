#include "core/distance/distance_tree.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include "core/distance/tree_kernel.h"
#include "core/distance/triangle_distance.h"
#include "core/machine/threads.h"
#include "core/mesh/triangle_runs.h"

namespace raycone {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kWidth = TrianglePack::kWidth;

// Packs of the triangles, and their boxes. Not a vector, which would clear the packs first: they are much memory, and
// clearing takes as long as filling.
std::unique_ptr<TrianglePack[]> make_packs(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                                           std::span<Box> boxes) {
  auto packs = std::make_unique_for_overwrite<TrianglePack[]>(boxes.size());
  constexpr std::size_t kPacksPerTask = 256;
  parallel_for_each(boxes.size(), kPacksPerTask, [&](std::size_t n) {
    const std::size_t first = n * kWidth;
    packs[n].set(mesh, triangles.subspan(first, std::min(kWidth, triangles.size() - first)));
    boxes[n] = packs[n].box();
  });
  return packs;
}

}  // namespace

DistanceTree::Node::Node() {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis].fill(kInfinity);
    upper[axis].fill(-kInfinity);
  }
}

void DistanceTree::Node::set(std::size_t child, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis][child] = box.lower[static_cast<int>(axis)];
    upper[axis][child] = box.upper[static_cast<int>(axis)];
  }
}

Box DistanceTree::Node::box() const {
  Box all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all.lower[static_cast<int>(axis)] = *std::ranges::min_element(lower[axis]);
    all.upper[static_cast<int>(axis)] = *std::ranges::max_element(upper[axis]);
  }
  return all;
}

DistanceTree::DistanceTree(const TriangleMesh& mesh, SimdLevel level)
    : triangles_(triangles_in_runs(mesh, kWidth)),
      pack_count_((triangles_.size() + kWidth - 1) / kWidth),
      simd_(level),
      search_(nearest_search(level)),
      find_packs_(pack_search(level)),
      slots_at_(slot_search(level)) {
  std::vector<Box> boxes(pack_count_);
  packs_ = make_packs(mesh, triangles_, boxes);
  while (boxes.size() > 1) {
    Level above((boxes.size() + kWidth - 1) / kWidth);
    for (std::size_t n = 0; n < boxes.size(); ++n) above[n / kWidth].set(n % kWidth, boxes[n]);
    boxes.resize(above.size());
    for (std::size_t n = 0; n < above.size(); ++n) boxes[n] = above[n].box();
    levels_.push_back(std::move(above));
  }
}

std::uint32_t DistanceTree::nearest_triangle(const Vec3& p) const {
  const double least = squared_distance(p);
  std::vector<std::uint32_t> near;
  find_packs({p, p}, beyond_error(least), pack_count_, near);
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint32_t pack : near) {
    for (std::uint32_t slots = slots_at_(packs_[pack], p, least); slots != 0; slots &= slots - 1) {
      const std::size_t number = pack * kWidth + static_cast<std::size_t>(std::countr_zero(slots));
      first = std::min(first, triangles_[std::min(number, triangles_.size() - 1)]);  // the last one fills its pack
    }
  }
  return first;
}

}  // namespace raycone
