// Distances from the samples of a small block of a lattice, in SIMD lanes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/crossings/lattice_rows.h"
#include "core/data/sample_box.h"
#include "core/distance/accurate_distance.h"
#include "core/distance/distance_tree.h"
#include "core/exact/scale.h"

namespace raycone {

// The largest side of a block that a kernel takes.
inline constexpr std::size_t kBlockSide = 8;
inline constexpr std::size_t kSamplesOfBlock = kBlockSide * kBlockSide * kBlockSide;

// The place of a sample among all of a block's, by its number along each axis.
[[nodiscard]] constexpr std::size_t place_in_block(const std::array<std::size_t, 3>& sample) {
  return (sample[2] * kBlockSide + sample[1]) * kBlockSide + sample[0];
}

// What reaches are multiplied by: more than roundings of sums take. beyond_error() adds those of distances.
inline constexpr double kReachSlack = 1 + 1e-9;

// Triangles that may be near some samples, in columns of equal length.
struct NearTriangles {
  std::array<std::vector<double>, 3> lower, upper;  // their boxes
  std::vector<std::int64_t> places;                 // in packs: the slot, and kWidth times the pack
  // From the middle of part of the samples. Where directions are not sure, they are 0, and the distance is one that all
  // of the samples have at least.
  std::vector<double> distances;
  std::array<std::vector<double>, 3> away;  // in which these distances grow
  double nearest_of_unsure = 0;  // of those without direction, how far the nearest is from the middle at most
  std::size_t count = 0;
};

// Thin triangles of a block that were prepared for more care, by their places; the last ones.
class AccurateTriangles {
 public:
  AccurateTriangles() { forget_all(); }
  void forget_all() { places_.fill(kNone); }

  // make() prepares it where it is not there. Valid until the next call.
  template <class Make>
  [[nodiscard]] const AccurateTriangle& at(std::size_t place, const Make& make) {
    const std::size_t n = place % kMost;
    if (places_[n] != place) {
      triangles_[n].emplace(make());
      places_[n] = place;
    }
    return *triangles_[n];
  }

 private:
  static constexpr std::size_t kMost = 61;  // kept at a time
  static constexpr std::size_t kNone = SIZE_MAX;
  std::array<std::size_t, kMost> places_;
  std::array<std::optional<AccurateTriangle>, kMost> triangles_{};
};

// What a task keeps from block to block.
struct BlockScratch {
  std::vector<std::uint32_t> packs;
  NearTriangles of_block, of_part;       // places: in `packed`
  std::vector<TrianglePack> packed;      // those of the block
  AccurateTriangles accurate;            // likewise
  std::vector<double> bounds;            // below the squares of those of the part, at all samples of a group
  std::vector<std::int64_t> candidates;  // their numbers
  alignas(64) std::array<double, kSamplesOfBlock> squares;  // by place_in_block()
};

// Samples and what is known about their nearest triangles.
struct BlockTask {
  const DistanceTree& tree;
  const LatticeRows& rows;
  SampleBox block;                       // each side at most kBlockSide
  double reach;                          // a triangle that is farther than this from all samples counts for none
  std::span<const std::uint32_t> packs;  // all that have a triangle that counts
};

// Sets scratch.squares to those of the nearest triangles (core/distance/triangle_distance.h) where these are not above
// reach^2, else to larger numbers or infinity. Needs DefaultFloatingPoint.
using BlockKernel = void (*)(const BlockTask& task, BlockScratch& scratch);

// Makes distances in world units of a block's squares, at most `band`. Returns whether one of them is below.
using RootKernel = bool (*)(std::span<double, kSamplesOfBlock> squares, const PowerOfTwo& to_world, double band);

// Those of the level, of the best one where the level is not available. Results are the same for every level.
[[nodiscard]] BlockKernel block_kernel(SimdLevel level);
[[nodiscard]] RootKernel root_kernel(SimdLevel level);

}  // namespace raycone
