#include "core/lattice_scan.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>

#include "core/threads.h"

namespace raycone {
namespace {

constexpr std::size_t kTrianglesPerTask = 2048;

// The values of one axis within [lower, upper] as [begin, end).
struct Range {
  std::size_t begin, end;
};

Range values_within(const std::vector<double>& values, double per_unit, double lower, double upper) {
  if (upper < values.front() || lower > values.back()) return {0, 0};
  return {count_below(values, per_unit, lower), count_up_to(values, per_unit, upper)};
}

}  // namespace

LatticeScan::LatticeScan(const TriangleMesh& mesh, const LatticeRows& rows) {
  std::vector<Found> parts;
  std::mutex mutex;
  parallel_for(mesh.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    Found found;
    for (std::size_t i = begin; i < end; ++i) scan(mesh, mesh.triangles[i], rows, found);
    const std::lock_guard<std::mutex> lock(mutex);
    parts.push_back(std::move(found));
  });
  sort_by_row(parts, rows.size());
}

void LatticeScan::scan(const TriangleMesh& mesh, const Triangle& triangle, const LatticeRows& rows, Found& found) {
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  const Range ks =
      values_within(rows.zs, rows.samples_per_unit.z, std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
  if (ks.begin == ks.end) return;
  const Range js =
      values_within(rows.ys, rows.samples_per_unit.y, std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
  if (js.begin == js.end || rows.xs.front() > std::max({a.x, b.x, c.x})) return;
  const TrianglePlane plane(a, b, c);
  for (std::size_t k = ks.begin; k < ks.end; ++k) {
    for (std::size_t j = js.begin; j < js.end; ++j) {
      const std::size_t row = k * rows.ys.size() + j;
      const TriangleCrossing crossing = triangle_crossing(a, b, c, rows.row(row), &plane);
      const auto number = static_cast<std::uint32_t>(row);
      if (crossing.crossed > 0) {
        found.crossed.push_back({number, static_cast<std::uint32_t>(crossing.crossed), crossing.sigma});
      }
      if (crossing.met > 0 || crossing.on_begin < crossing.on_end) found.degenerate.push_back({number, crossing});
    }
  }
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
