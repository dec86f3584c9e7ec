#include "core/cells/cell_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/data/interval.h"
#include "core/machine/buckets.h"
#include "core/machine/first_touch.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

struct InCell {
  std::uint32_t cell, triangle;
};

constexpr double kMargin = 0x1p-6;  // of a cell's side, far above all rounding up to ...
constexpr double kFar = 0x1p40;     // ... so many cells

struct CellRange {
  std::int64_t first, last;
};

// A convex polygon. One of its sides may be a point.
struct Polygon {
  std::array<Vec3, 6> corners;
  std::size_t count = 0;
};

// The part of a segment between the planes at `low` and `high` across an axis: visits its ends, where there is one.
template <class Visit>
void clip(const Vec3& p, const Vec3& q, int axis, double low, double high, const Visit& visit) {
  const double from = p[axis], to = q[axis];
  if (std::max(from, to) < low || std::min(from, to) > high) return;
  const auto at = [&](double plane) { return p + ((plane - from) / (to - from)) * (q - p); };
  visit(from < low ? at(low) : from > high ? at(high) : p);
  visit(to < low ? at(low) : to > high ? at(high) : q);
}

// Finds which cells a triangle comes into, layer by layer. In units of cells, from the lowest one on, so that extremes
// neither over- nor underflow.
class CellFinder {
 public:
  CellFinder(const TriangleMesh& mesh, const SurfaceCells& cells) : mesh_(mesh), cells_(cells) {}

  [[nodiscard]] CellRange layers(std::uint32_t triangle) const { return range(2, extent(corners(triangle), 2)); }

  template <class Found>
  void find(std::uint32_t triangle, std::int64_t layer, const Found& found) const {
    const Corners3 corners = this->corners(triangle);
    if (is_far(corners)) return find_all(corners, layer, found);
    const auto low = static_cast<double>(layer) - kMargin, high = static_cast<double>(layer + 1) + kMargin;
    Polygon part;
    Interval y = kEmptyInterval;
    for (std::size_t n = 0; n < 3; ++n) {
      clip(corners[n], corners[(n + 1) % 3], 2, low, high, [&](const Vec3& p) {
        part.corners[part.count++] = p;
        extend(y, p.y);
      });
    }
    const CellRange rows = range(1, y);
    for (std::int64_t row = rows.first; row <= rows.last; ++row) find_in_row(section(part, row), row, layer, found);
  }

 private:
  [[nodiscard]] Corners3 corners(std::uint32_t triangle) const {
    Corners3 corners = corners_of(mesh_, mesh_.triangles[triangle]);
    for (Vec3& corner : corners) corner = cells_.lattice().steps_from_first(corner);
    return corners;
  }

  [[nodiscard]] static bool is_far(const Corners3& corners) {
    return !std::ranges::all_of(
        corners, [](const Vec3& p) { return std::abs(p.x) < kFar && std::abs(p.y) < kFar && std::abs(p.z) < kFar; });
  }

  [[nodiscard]] static Interval extent(const Corners3& corners, int axis) {
    Interval result = kEmptyInterval;
    for (const Vec3& p : corners) extend(result, p[axis]);
    return result;
  }

  // Of a part of one layer, where it is in a row: its extent along x.
  [[nodiscard]] static Interval section(const Polygon& part, std::int64_t row) {
    const auto low = static_cast<double>(row) - kMargin, high = static_cast<double>(row + 1) + kMargin;
    Interval x = kEmptyInterval;
    for (std::size_t n = 0; n < part.count; ++n) {
      clip(part.corners[n], part.corners[n + 1 < part.count ? n + 1 : 0], 1, low, high,
           [&](const Vec3& p) { extend(x, p.x); });
    }
    return x;
  }

  // Indices of cells along an axis; none where the interval is empty, or beyond the lattice.
  [[nodiscard]] CellRange range(int axis, const Interval& interval) const {
    const auto count = cells_.lattice().counts[static_cast<std::size_t>(axis)];
    const auto cell = [&](double x) {
      return static_cast<std::int64_t>(std::floor(std::clamp(x, -1.0, static_cast<double>(count))));
    };
    return {std::max<std::int64_t>(cell(interval.lower - kMargin), 0),
            std::min(cell(interval.upper + kMargin), count - 1)};
  }

  template <class Found>
  void find_in_row(const Interval& x, std::int64_t row, std::int64_t layer, const Found& found) const {
    const CellRange along = range(0, x);
    const std::uint32_t end = cells_.row_end(row, layer);
    std::uint32_t cell = cells_.row_begin(row, layer);
    if (cell == end) return;
    cell = cells_.first_from(cell, end, along.first);
    for (; cell < end && cells_.cells()[cell].node[0] <= along.last; ++cell) found(cell);
  }

  // All cells of the layer that meet the triangle's box.
  template <class Found>
  void find_all(const Corners3& corners, std::int64_t layer, const Found& found) const {
    const CellRange rows = range(1, extent(corners, 1));
    for (std::int64_t row = rows.first; row <= rows.last; ++row) find_in_row(extent(corners, 0), row, layer, found);
  }

  const TriangleMesh& mesh_;
  const SurfaceCells& cells_;
};

}  // namespace

// Layer by layer, each with its triangles in increasing order.
CellTriangles::CellTriangles(const TriangleMesh& mesh, const SurfaceCells& cells)
    : begin_(cells.cells().size() + 1, 0) {
  const CellFinder finder(mesh, cells);
  const auto count = static_cast<std::size_t>(cells.lattice().counts[2]);
  const Buckets<std::uint32_t> triangles(mesh.triangles.size(), count,
                                         [&](std::size_t begin, std::size_t end, const auto& emit) {
                                           for (std::size_t i = begin; i < end; ++i) {
                                             const auto triangle = static_cast<std::uint32_t>(i);
                                             const CellRange layers = finder.layers(triangle);
                                             for (std::int64_t k = layers.first; k <= layers.last; ++k)
                                               emit(static_cast<std::size_t>(k), triangle);
                                           }
                                         });
  std::vector<std::vector<InCell>> layers(count);
  const auto for_each_layer = [&](const auto& visit) { parallel_for_each(count, visit); };
  for_each_layer([&](std::size_t k) {
    for (const std::uint32_t triangle : triangles[k]) {
      finder.find(triangle, static_cast<std::int64_t>(k), [&](std::uint32_t cell) {
        layers[k].push_back({cell, triangle});
        ++begin_[cell + 1];
      });
    }
  });
  for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
  resize_on_all_threads(triangles_, begin_.back());
  for_each_layer([&](std::size_t k) {
    for (const InCell& one : layers[k]) triangles_[begin_[one.cell]++] = one.triangle;
    layers[k] = {};
  });
  // Each is where the next one begins now.
  for (std::size_t cell = begin_.size() - 1; cell > 0; --cell) begin_[cell] = begin_[cell - 1];
  begin_[0] = 0;
}

}  // namespace raycone
