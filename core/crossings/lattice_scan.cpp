#include "core/crossings/lattice_scan.h"

#include <algorithm>

#include "core/crossings/triangle_sections.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;

constexpr std::size_t kVerticesPerTask = 8192;

constexpr std::size_t kGroupsPerTask = 4;

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

struct VertexPlace {
  Place y, z;
};

VertexPlace place_of(const Vec3& v, const LatticeRows& rows) {
  return {place_of(v.y, rows.ys, rows.samples_per_unit.y), place_of(v.z, rows.zs, rows.samples_per_unit.z)};
}

// One triangle, whose corners are at these places. Most meet no row: their corners are not looked at.
void scan(const TriangleMesh& mesh, const Triangle& t, const VertexPlace& pa, const VertexPlace& pb,
          const VertexPlace& pc, const LatticeRows& rows, LatticeSums::Collector& collector) {
  const Range ks = range_of(pa.z, pb.z, pc.z), js = range_of(pa.y, pb.y, pc.y);
  if (static_cast<int>(ks.empty()) | static_cast<int>(js.empty())) return;
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  if (rows.xs.front() > std::max({a.x, b.x, c.x})) return;
  const TrianglePlane plane(a, b, c);
  visit_rows(a, b, c, rows, js, ks, [&](std::uint32_t j, std::uint32_t k) {
    const Row row{rows.ys[j], rows.zs[k], rows.xs, rows.samples_per_unit.x};
    collector.add(k * rows.ys.size() + j, triangle_crossing(a, b, c, row, &plane));
  });
}

// All of them. Where a vertex lies is looked up once per vertex, not per triangle: most triangles of a fine mesh meet
// no row, and need nothing else.
void scan_all(const TriangleMesh& mesh, const LatticeRows& rows, LatticeSums& sums) {
  std::vector<VertexPlace> places(mesh.vertices.size());
  parallel_for(places.size(), kVerticesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[i] = place_of(mesh.vertices[i], rows);
  });
  parallel_for(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle& t = mesh.triangles[i];
      scan(mesh, t, places[t[0]], places[t[1]], places[t[2]], rows, collector);
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
        scan(mesh, t, place_of(a, rows), place_of(b, rows), place_of(c, rows), rows, collector);
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
