// Crossings of all rows of a lattice at once, without an acceleration structure: the classical scan conversion of the
// triangles, projected along the rays, with exact predicates in place of a fill rule.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/crossings/lattice_sums.h"
#include "core/crossings/row.h"
#include "core/crossings/slab_order.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Rows (y, z) for all y of ys and z of zs, with the samples xs each; all ascending. Row number j + k * ys.size() is
// (ys[j], zs[k]).
struct LatticeRows {
  std::vector<double> xs, ys, zs;
  Vec3 samples_per_unit;  // as in Row, per axis

  [[nodiscard]] std::size_t size() const { return ys.size() * zs.size(); }
  [[nodiscard]] Row row(std::size_t number) const {
    return {ys[number % ys.size()], zs[number / ys.size()], xs, samples_per_unit.x};
  }
};

// The triangles of a mesh in their order along an axis across the slabs, 1 or 2.
struct OrderedSlab {
  const SlabOrder& order;
  int axis;
};

// Adds what the triangles of a mesh say about each row to `sums`, which is of these rows. `slab`: where
// the rows are one of many. Threaded over triangles. Fewer than
// 2^32 coordinates along y and along z.
void scan_triangles(const TriangleMesh& mesh, const LatticeRows& rows, const std::optional<OrderedSlab>& slab,
                    LatticeSums& sums);

}  // namespace raycone
