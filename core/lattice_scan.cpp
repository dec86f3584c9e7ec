#include "core/lattice_scan.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/threads.h"
#include "core/triangle_sections.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;

constexpr std::size_t kVerticesPerTask = 8192;

// Where a number lies among ascending values: how many of them are below it, and not above it.
struct Place {
  std::uint32_t below, up_to;
};

Place place_of(double x, const std::vector<double>& values, double per_unit) {
  const std::size_t below = count_below(values, per_unit, x);
  std::size_t up_to = below;
  while (up_to < values.size() && values[up_to] == x) ++up_to;
  return {static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(up_to)};
}

// The values within the interval that three numbers span, as [begin, end).
struct Range {
  std::uint32_t begin, end;
  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

Range range_of(const Place& a, const Place& b, const Place& c) {
  return {std::min({a.below, b.below, c.below}), std::max({a.up_to, b.up_to, c.up_to})};
}

// Calls visit(j, k) for the rows that the triangle may concern, of those in its box.
template <class Visit>
void visit_rows(const Vec3& a, const Vec3& b, const Vec3& c, const LatticeRows& rows, const Range& js, const Range& ks,
                const Visit& visit) {
  constexpr std::uint32_t kFew = 6;  // rows, not worth a section
  if (std::max(js.size(), ks.size()) <= kFew) {
    for (std::uint32_t k = ks.begin; k < ks.end; ++k) {
      for (std::uint32_t j = js.begin; j < js.end; ++j) visit(j, k);
    }
  } else if (js.size() >= ks.size()) {
    const TriangleSections sections(a, b, c, 1);
    for (std::uint32_t k = ks.begin; k < ks.end; ++k) {
      sections.visit(rows.zs[k], rows.ys, rows.samples_per_unit.y, js.begin, js.end,
                     [&](std::uint32_t j) { visit(j, k); });
    }
  } else {
    const TriangleSections sections(a, b, c, 2);
    for (std::uint32_t j = js.begin; j < js.end; ++j) {
      sections.visit(rows.ys[j], rows.zs, rows.samples_per_unit.z, ks.begin, ks.end,
                     [&](std::uint32_t k) { visit(j, k); });
    }
  }
}

}  // namespace

struct LatticeScan::VertexPlace {
  Place y, z;
};

LatticeScan::LatticeScan(const TriangleMesh& mesh, const LatticeRows& rows) {
  // Once per vertex, not per triangle: most triangles of a fine mesh meet no row, and need nothing else.
  std::vector<VertexPlace> places(mesh.vertices.size());
  parallel_for(places.size(), kVerticesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& v = mesh.vertices[i];
      places[i] = {place_of(v.y, rows.ys, rows.samples_per_unit.y), place_of(v.z, rows.zs, rows.samples_per_unit.z)};
    }
  });
  std::vector<Found> parts;
  std::mutex mutex;
  parallel_for(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    Found found;
    for (std::size_t i = begin; i < end; ++i) scan(mesh, places, mesh.triangles[i], rows, found);
    const std::lock_guard<std::mutex> lock(mutex);
    parts.push_back(std::move(found));
  });
  sort_by_row(parts, rows.size());
}

void LatticeScan::scan(const TriangleMesh& mesh, const std::vector<VertexPlace>& places, const Triangle& triangle,
                       const LatticeRows& rows, Found& found) {
  const VertexPlace &pa = places[triangle[0]], &pb = places[triangle[1]], &pc = places[triangle[2]];
  const Range ks = range_of(pa.z, pb.z, pc.z), js = range_of(pa.y, pb.y, pc.y);
  if (static_cast<int>(ks.empty()) | static_cast<int>(js.empty())) return;
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  if (rows.xs.front() > std::max({a.x, b.x, c.x})) return;
  const TrianglePlane plane(a, b, c);
  const auto visit = [&](std::uint32_t j, std::uint32_t k) {
    const Row row{rows.ys[j], rows.zs[k], rows.xs, rows.samples_per_unit.x};
    const TriangleCrossing crossing = triangle_crossing(a, b, c, row, &plane);
    const auto number = static_cast<std::uint32_t>(k * rows.ys.size() + j);
    if (crossing.crossed > 0) {
      found.crossed.push_back({number, static_cast<std::uint32_t>(crossing.crossed), crossing.sigma});
    }
    if (crossing.met > 0 || crossing.on_begin < crossing.on_end) found.degenerate.push_back({number, crossing});
  };
  visit_rows(a, b, c, rows, js, ks, visit);
}

void LatticeScan::sort_by_row(const std::vector<Found>& parts, std::size_t rows) {
  begin_.assign(rows + 2, 0);
  for (const Found& part : parts) {
    for (const Crossed& c : part.crossed) ++begin_[c.row + 2];
    degenerate_.insert(degenerate_.end(), part.degenerate.begin(), part.degenerate.end());
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  crossings_.resize(begin_.back());
  // begin_[row + 1] is the row's next free place, and its end when all are filled.
  for (const Found& part : parts) {
    for (const Crossed& c : part.crossed) crossings_[begin_[c.row + 1]++] = {c.samples, c.sigma};
  }
  std::sort(degenerate_.begin(), degenerate_.end(),
            [](const Degenerate& a, const Degenerate& b) { return a.row < b.row; });
}

void LatticeScan::get(std::size_t row, RowCrossings& crossings) const {
  crossings.clear();
  crossings.crossings.assign(crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[row]),
                             crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[row + 1]));
  const auto before = [](const Degenerate& d, std::size_t number) { return d.row < number; };
  auto it = std::lower_bound(degenerate_.begin(), degenerate_.end(), row, before);
  for (; it != degenerate_.end() && it->row == row; ++it) {
    TriangleCrossing rest = it->crossing;
    rest.crossed = 0;  // listed above
    crossings.add(rest);
  }
}

}  // namespace raycone
