#include "core/contour/vertex_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/contour/contour.h"
#include "core/data/coordinate_precision.h"
#include "core/machine/sum_over.h"

namespace raycone {
namespace {

// The part of a cell that a chain of corners spans, from the cell's lowest one on. In fractions of the cell, the axes
// that a step of the chain adds have one coordinate; it decreases from step to step, from 1 down to 0.
class ChainPlace {
 public:
  ChainPlace(const SurfaceCells& cells, double margin) : cells_(cells), margin_(margin) {}

  [[nodiscard]] bool holds(const Vec3& p, const SurfaceCell& cell, std::span<const unsigned> chain) const {
    const std::array<double, 3> at = place_in(cell, p);
    double last = 1.0;
    unsigned reached = 0;
    for (const unsigned corner : chain) {
      const double here = at[first_axis(corner ^ reached)];
      if (!(last - here >= margin_ / 2) || !all_at(at, corner ^ reached, here)) return false;
      last = here;
      reached = corner;
    }
    return last >= margin_ / 2 && all_at(at, kuhn::kCorners - 1 - reached, 0.0);
  }

  [[nodiscard]] bool holds(const Vec3& p, const SurfaceCell& cell) const {
    const std::array<double, 3> at = place_in(cell, p);
    return std::ranges::all_of(at, [&](double x) { return x >= margin_ / 2 && x <= 1.0 - margin_ / 2; });
  }

 private:
  // In fractions of the cell.
  [[nodiscard]] std::array<double, 3> place_in(const SurfaceCell& cell, const Vec3& p) const {
    const Vec3 low = cells_.corner(cell, 0);
    const Vec3& h = cells_.lattice().spacing;
    return {(p.x - low.x) / h.x, (p.y - low.y) / h.y, (p.z - low.z) / h.z};
  }
  [[nodiscard]] static std::size_t first_axis(unsigned axes) { return (axes & 1U) != 0 ? 0 : (axes & 2U) != 0 ? 1 : 2; }
  [[nodiscard]] bool all_at(const std::array<double, 3>& at, unsigned axes, double where) const {
    for (std::size_t axis = 0; axis < at.size(); ++axis) {
      if ((axes >> axis & 1U) != 0 && !(std::abs(at[axis] - where) <= margin_ / 16)) return false;
    }
    return true;
  }

  const SurfaceCells& cells_;
  double margin_;
};

}  // namespace

std::uint64_t misplaced_vertices(const ContourPoints& points, const SurfaceCells& cells, const FacePoints& face_points,
                                 std::span<const std::uint64_t> tetrahedra, double margin) {
  const ChainPlace place(cells, margin);
  const auto as_written = [&](const Vec3& p) { return rounded_to(points.precision, p); };
  const auto at_edges = [&](std::size_t n) {
    const SurfaceCell& cell = cells.cells()[n];
    std::uint64_t wrong = 0;
    for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
      if (!cell.has_edge(direction)) continue;
      wrong +=
          place.holds(as_written(points.edges[cell.edge(direction)].position), cell, std::array{direction}) ? 0 : 1;
    }
    return wrong;
  };
  const auto is_out_of_face = [&](const Vec3& p, std::uint64_t face) {
    const auto [first, second] = kuhn::kFaces[face_in_cell(face)];
    const SurfaceCell& cell = cells.cells()[cell_of_face(face)];
    return place.holds(p, cell, std::array{first, second}) ? 0U : 1U;
  };
  const auto at_face = [&](std::size_t n) {
    return is_out_of_face(as_written(points.faces[n]), face_points.faces()[n]);
  };
  const auto at_apex = [&](std::size_t n) {
    const Vec3 p = as_written(points.apexes[n]);
    if ((tetrahedra[n] & kWholeCell) != 0) return place.holds(p, cells.cells()[tetrahedra[n] & ~kWholeCell]) ? 0U : 1U;
    if ((tetrahedra[n] & kFaceOfCell) != 0) return is_out_of_face(p, tetrahedra[n] & ~kFaceOfCell);
    const kuhn::Tetrahedron& tetrahedron = kuhn::kTetrahedra[tetrahedra[n] % kuhn::kTetrahedra.size()];
    const SurfaceCell& cell = cells.cells()[tetrahedra[n] / kuhn::kTetrahedra.size()];
    return place.holds(p, cell, std::span(tetrahedron.corners).subspan(1)) ? 0U : 1U;
  };
  return sum_over(cells.cells().size(), at_edges) + sum_over(face_points.faces().size(), at_face) +
         sum_over(tetrahedra.size(), at_apex);
}

}  // namespace raycone
