#include "core/crossings/lattice_scan.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/crossings/triangle_sections.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;

constexpr std::size_t kVerticesPerTask = 8192;

constexpr std::size_t kGroupsPerTask = 4;

// Rows [begin, end) along y or z.
struct RowRange {
  std::uint32_t begin, end;
  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

// The values that equal x among ascending ones: where there are none, both ends tell where x lies.
RowRange equal_range(double x, const std::vector<double>& values, double per_unit) {
  const std::size_t below = count_below(values, per_unit, x);
  std::size_t up_to = below;
  while (up_to < values.size() && values[up_to] == x) ++up_to;
  return {static_cast<std::uint32_t>(below), static_cast<std::uint32_t>(up_to)};
}

// The values within the interval that three numbers span.
RowRange hull(const RowRange& a, const RowRange& b, const RowRange& c) {
  return {std::min({a.begin, b.begin, c.begin}), std::max({a.end, b.end, c.end})};
}

// Where a vertex, or the box of a triangle, lies among the rows.
struct BoxRows {
  RowRange js, ks;  // along y, z
};

BoxRows rows_at(const Vec3& v, const LatticeRows& rows) {
  return {equal_range(v.y, rows.ys, rows.samples_per_unit.y), equal_range(v.z, rows.zs, rows.samples_per_unit.z)};
}

BoxRows hull(const BoxRows& a, const BoxRows& b, const BoxRows& c) {
  return {hull(a.js, b.js, c.js), hull(a.ks, b.ks, c.ks)};
}

// Calls visit(j, k) for the rows that the triangle may concern, of those `in_box`.
template <class Visit>
void visit_rows(const Corners3& corners, const LatticeRows& rows, const BoxRows& in_box, const Visit& visit) {
  constexpr std::uint32_t kFew = 6;  // rows, not worth a section
  const auto& [a, b, c] = corners;
  const auto& [js, ks] = in_box;
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

// One triangle. Most meet no row: their corners are not fetched.
void scan(const TriangleMesh& mesh, const Triangle& t, const BoxRows& in_box, const LatticeRows& rows,
          LatticeSums::Collector& collector) {
  if (static_cast<int>(in_box.ks.empty()) | static_cast<int>(in_box.js.empty())) return;
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  if (rows.xs.front() > std::max({a.x, b.x, c.x})) return;
  const TrianglePlane plane(a, b, c);
  visit_rows({a, b, c}, rows, in_box, [&](std::uint32_t j, std::uint32_t k) {
    const Row row{rows.ys[j], rows.zs[k], rows.xs, rows.samples_per_unit.x};
    collector.add(k * rows.ys.size() + j, triangle_crossing(a, b, c, row, &plane));
  });
}

// All of them. Where a vertex lies is looked up once per vertex, not per triangle: most triangles of a fine mesh meet
// no row, and need nothing else.
void scan_all(const TriangleMesh& mesh, const LatticeRows& rows, LatticeSums& sums) {
  std::vector<BoxRows> at(mesh.vertices.size());
  parallel_for_each(at.size(), kVerticesPerTask, [&](std::size_t i) { at[i] = rows_at(mesh.vertices[i], rows); });
  parallel_for(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      scan(mesh, t, hull(at[t[0]], at[t[1]], at[t[2]]), rows, collector);
    }
    collector.finish();
  });
}

void scan_slab(const TriangleMesh& mesh, const LatticeRows& rows, const OrderedSlab& slab, LatticeSums& sums) {
  const std::vector<double>& across = slab.axis == 1 ? rows.ys : rows.zs;
  const std::vector<std::uint32_t> groups = slab.order.groups_in(across.front(), across.back());
  parallel_for(groups.size(), kGroupsPerTask, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    for (std::size_t n = begin; n < end; ++n) {
      for (const std::uint32_t i : slab.order[groups[n]]) {
        const Triangle& t = mesh.triangles[i];
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const auto [lower, upper] = std::minmax({a[slab.axis], b[slab.axis], c[slab.axis]});
        if (lower > across.back() || upper < across.front()) continue;
        scan(mesh, t, hull(rows_at(a, rows), rows_at(b, rows), rows_at(c, rows)), rows, collector);
      }
    }
    collector.finish();
  });
}

}  // namespace

void scan_triangles(const TriangleMesh& mesh, const LatticeRows& rows, const std::optional<OrderedSlab>& slab,
                    LatticeSums& sums) {
  if (slab) {
    scan_slab(mesh, rows, *slab, sums);
  } else {
    scan_all(mesh, rows, sums);
  }
}

}  // namespace raycone
