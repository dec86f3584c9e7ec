// Distances from the samples of a lattice to the nearest triangle, as far as a band around the triangles.
#pragma once

#include <functional>
#include <limits>
#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/distance/distance_tree.h"

namespace raycone {

// What samples get.
struct BandNumbers {
  std::function<void(std::span<double> squares)> finish;  // makes numbers of squares, in place; called from all threads
  double beyond;                                          // the number of samples that are surely beyond the band
};

// numbers[i + nx (j + ny k)], for sample (xs[i], ys[j], zs[k]) of `rows`, becomes what `which` makes of the square of
// the distance to the nearest triangle (core/distance/triangle_distance.h) where that is not above `band`; elsewhere
// what it makes of a larger number or infinity, or which.beyond. Coordinates of samples are below 2^400 in magnitude.
// Threaded over strips of the lattice. Numbers do not depend on threads.
void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, const BandNumbers& which,
               std::span<double> numbers);

// The squares as they are, infinity beyond the band.
inline void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares) {
  fill_band(tree, rows, band, {[](std::span<double>) {}, std::numeric_limits<double>::infinity()}, squares);
}

}  // namespace raycone
