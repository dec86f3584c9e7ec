// Distances from the samples of a lattice to the nearest triangle, as far as a band around the triangles.
#pragma once

#include <span>

#include "core/crossings/lattice_rows.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/distance_tree.h"

namespace raycone {

// Of each way: squares[i + nx (j + ny k)], for sample (xs[i], ys[j], zs[k]) of `rows`, becomes the square of the
// distance to the nearest triangle (core/distance/triangle_distance.h) where that is not above `band`; elsewhere a
// larger number or infinity. The largest coordinate of the mesh is in [1/2, 1], those of samples are below 2^400 in
// magnitude. Threaded over strips of the lattice. Both ways compute the same bits.

// Each triangle visits the samples around it.
void rasterize_distances(const TriangleMesh& mesh, const LatticeRows& rows, double band, std::span<double> squares);

// From blocks to parts of blocks, as long as a triangle may be near, down to samples; each looks up its nearest
// triangle.
void descend_to_distances(const DistanceTree& tree, const LatticeRows& rows, double band, std::span<double> squares);

// Whether the first way visits so many samples that the second is faster: where triangles are small for the band.
[[nodiscard]] bool descent_is_faster(const TriangleMesh& mesh, double band);

}  // namespace raycone
