// Crossings of all rows of a lattice at once, without an acceleration structure: the classical scan conversion of the
// triangles, projected along the rays, with exact predicates in place of a fill rule.
#pragma once

#include <optional>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/crossings/slab_order.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The triangles of a mesh in their order along an axis across the slabs, 1 or 2.
struct OrderedSlab {
  const SlabOrder& order;
  int axis;
};

// Adds what the triangles of a mesh say about each row to `sums`, which is of these rows. `slab`: where the rows are
// one of many. Threaded over triangles. Fewer than 2^32 coordinates along y and along z.
void scan_triangles(const TriangleMesh& mesh, const LatticeRows& rows, const std::optional<OrderedSlab>& slab,
                    LatticeSums& sums);

}  // namespace raycone
