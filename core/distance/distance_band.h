// Distances from the samples of a lattice to the nearest triangle, as far as a band around the triangles.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/distance/block_kernel.h"
#include "core/distance/distance_tree.h"

namespace raycone {

// Blocks begin at indices of the lattice that are multiples of 8. Per axis: the index of the first sample modulo 8.
using BlockPhase = std::array<std::size_t, 3>;

// Who wants to know of the band. Called from all threads, but from one of a strip of blocks.
struct BandVisitor {
  // Samples that are surely beyond the band.
  std::function<void(const SampleBox& samples)> beyond;
  // Samples of one block, and room for what may be made of them: place_in_block() of their numbers in the block is the
  // place of the square of the distance to the nearest triangle (core/distance/triangle_distance.h) where that is not
  // above the band's, else of a larger number or infinity.
  std::function<void(const SampleBox& samples, std::span<double, kSamplesOfBlock> squares)> block;
};

// Visits all samples (xs[i], ys[j], zs[k]) of `rows` that may be within `band`. Coordinates of samples are below 2^400
// in magnitude. Threaded over strips, blocks that have the same place along `axis`, which is 1 or 2. Numbers depend
// neither on that nor on threads.
void visit_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BlockPhase& phase,
                std::size_t axis, const BandVisitor& visitor);

// What samples get.
struct BandNumbers {
  // Makes numbers of a block's squares, in place. Called from all threads.
  std::function<void(std::span<double, kSamplesOfBlock> squares)> finish;
  double beyond;  // the number of samples that are surely beyond the band
};

// numbers[i + nx (j + ny k)], for sample (xs[i], ys[j], zs[k]), becomes what `which` makes of its square, or
// which.beyond.
void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BandNumbers& which,
               std::span<double> numbers);

// The squares as they are, infinity beyond the band.
inline void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares) {
  fill_band(tree, rows, band, {[](std::span<double, kSamplesOfBlock>) {}, std::numeric_limits<double>::infinity()},
            squares);
}

}  // namespace raycone
