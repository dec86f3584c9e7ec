// Distances from the samples of a lattice to the nearest triangle, as far as a band around the triangles.
#pragma once

#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/distance/distance_tree.h"

namespace raycone {

// squares[i + nx (j + ny k)], for sample (xs[i], ys[j], zs[k]) of `rows`, becomes the square of the distance to the
// nearest triangle (core/distance/triangle_distance.h) where that is not above `band`; elsewhere a larger number or
// infinity. Coordinates of samples are below 2^400 in magnitude. Threaded over strips of the lattice. Numbers do not
// depend on threads.
void fill_band(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares);

}  // namespace raycone
