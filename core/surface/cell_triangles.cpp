#include "core/surface/cell_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/exact/projection.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

struct InCell {
  std::uint32_t cell, triangle;
};

constexpr double kMargin = 0x1p-6;  // of a cell's side, far above all rounding

// Collects the cells of one triangle after the other.
class CellFinder {
 public:
  CellFinder(const TriangleMesh& mesh, const SurfaceCells& cells) : mesh_(mesh), cells_(cells) {}

  void find(std::uint32_t triangle, std::vector<InCell>& found) const {
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
    const Range x = range(0, a, b, c), y = range(1, a, b, c), z = range(2, a, b, c);
    const Vec3& h = cells_.lattice().spacing;
    // In units of cells, so that extremes neither over- nor underflow.
    const auto scaled = [&](const Vec3& v) { return Vec3{v.x / h.x, v.y / h.y, v.z / h.z}; };
    const Vec3 u = scaled(b - a), v = scaled(c - a), normal = cross(u, v), terms = cross_terms(u, v);
    const double reach = (0.5 + kMargin) * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
    for (std::int64_t k = z.first; k <= z.last; ++k) {
      for (std::int64_t j = y.first; j <= y.last; ++j) {
        const std::uint32_t end = cells_.row_end(j, k);
        for (std::uint32_t n = cells_.first_from(cells_.row_begin(j, k), end, x.first); n < end; ++n) {
          const SurfaceCell& cell = cells_.cells()[n];
          if (cell.node[0] > x.last) break;
          const Vec3 low = cells_.position(cell.node);
          const Vec3 middle = scaled(low - a) + Vec3{0.5, 0.5, 0.5};
          const double rounding = kTurnTrust * dot(terms, absolute(middle));
          if (std::abs(dot(normal, middle)) > reach + rounding) continue;  // the plane passes it by
          found.push_back({n, triangle});
        }
      }
    }
  }

 private:
  struct Range {
    std::int64_t first, last;
  };

  // Indices of cells along an axis, from 0; none where the triangle is beyond the lattice.
  [[nodiscard]] Range range(int axis, const Vec3& a, const Vec3& b, const Vec3& c) const {
    const Lattice& lattice = cells_.lattice();
    const auto n = static_cast<std::size_t>(axis);
    const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
    const auto cell = [&](double coordinate, double margin) {
      const double index = (coordinate - lattice.origin[axis]) / lattice.spacing[axis] + margin;
      const double from_0 = std::floor(index) - static_cast<double>(lattice.index_min[n]);
      return static_cast<std::int64_t>(std::clamp(from_0, -1.0, static_cast<double>(lattice.counts[n])));
    };
    return {std::max<std::int64_t>(cell(low, -kMargin), 0), std::min(cell(high, kMargin), lattice.counts[n] - 1)};
  }

  const TriangleMesh& mesh_;
  const SurfaceCells& cells_;
};

}  // namespace

CellTriangles::CellTriangles(const TriangleMesh& mesh, const SurfaceCells& cells)
    : begin_(cells.cells().size() + 1, 0) {
  const CellFinder finder(mesh, cells);
  std::vector<std::vector<InCell>> parts;  // in any order; one vector of all would be moved as it grows
  std::mutex mutex;
  parallel_for(mesh.triangles.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<InCell> found;
    for (std::size_t i = begin; i < end; ++i) finder.find(static_cast<std::uint32_t>(i), found);
    const std::scoped_lock lock(mutex);
    parts.push_back(std::move(found));
  });
  for (const std::vector<InCell>& part : parts) {
    for (const InCell& one : part) ++begin_[one.cell + 1];
  }
  for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
  triangles_.resize(begin_.back());
  std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
  for (const std::vector<InCell>& part : parts) {
    for (const InCell& one : part) triangles_[next[one.cell]++] = one.triangle;
  }
  parallel_for(begin_.size() - 1, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto at = [&](std::size_t n) { return triangles_.begin() + static_cast<std::ptrdiff_t>(begin_[n]); };
      std::sort(at(cell), at(cell + 1));
    }
  });
}

}  // namespace raycone
