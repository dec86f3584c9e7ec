// Crossings of all rows of a lattice at once, without an acceleration structure: the classical scan conversion of the
// triangles, projected along the rays, with exact predicates in place of a fill rule.
#pragma once

#include <cstdint>
#include <vector>

#include "core/crossings.h"
#include "core/row.h"
#include "core/triangle_mesh.h"

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

// What the triangles of a mesh say about each row.
class LatticeScan {
 public:
  // Threaded over triangles. rows.size() < 2^32.
  LatticeScan(const TriangleMesh& mesh, const LatticeRows& rows);

  // Replaces `crossings` by those of a row; in an order of no meaning.
  void get(std::size_t row, RowCrossings& crossings) const;

 private:
  struct Crossed {
    std::uint32_t row;
    std::uint32_t samples;
    std::int32_t sigma;
  };
  struct Degenerate {  // rare: ties, or samples on the surface
    std::uint32_t row;
    TriangleCrossing crossing;
  };
  struct Found {
    std::vector<Crossed> crossed;
    std::vector<Degenerate> degenerate;
  };

  struct VertexPlace;

  static void scan(const TriangleMesh& mesh, const std::vector<VertexPlace>& places, const Triangle& triangle,
                   const LatticeRows& rows, Found& found);
  void sort_by_row(const std::vector<Found>& parts, std::size_t rows);

  std::vector<std::size_t> begin_;  // per row, into crossings_; and the end
  std::vector<RowCrossings::Ending> crossings_;
  std::vector<Degenerate> degenerate_;  // by row
};

}  // namespace raycone
