#include "core/crossings.h"

#include <algorithm>

#include "core/predicates.h"

namespace raycone {
namespace {

// Adding at `end` what holds for the samples [0, end) makes the value of a sample the sum from its place on.
void sum_from_the_end(std::vector<std::int64_t>& ends) {
  for (std::size_t i = ends.size() - 1; i-- > 0;) ends[i] += ends[i + 1];
}

}  // namespace

// While counting, crossings[m] and degenerate[m] hold what ends with sample m - 1.
void RowCrossings::count(const TriangleMesh& mesh, std::span<const std::uint32_t> candidates, const Row& row) {
  const std::size_t samples = row.xs.size();
  crossings.assign(samples + 1, 0);
  degenerate.assign(samples + 1, 0);
  on_surface.assign(samples, 0);
  for (const std::uint32_t candidate : candidates) {
    const Triangle& t = mesh.triangles[candidate];
    add(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], row);
  }
  sum_from_the_end(crossings);
  sum_from_the_end(degenerate);
  // Sample i is what ends at i + 1 or later.
  crossings.erase(crossings.begin());
  degenerate.erase(degenerate.begin());
}

void RowCrossings::add(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row) {
  if (row.y < std::min({a.y, b.y, c.y}) || row.y > std::max({a.y, b.y, c.y})) return;
  if (row.z < std::min({a.z, b.z, c.z}) || row.z > std::max({a.z, b.z, c.z})) return;
  const auto place = [&](auto it) { return static_cast<std::size_t>(it - row.xs.begin()); };
  // Samples before `box_begin` have the box ahead, those from `box_end` on have it behind.
  const std::size_t box_end = place(std::upper_bound(row.xs.begin(), row.xs.end(), std::max({a.x, b.x, c.x})));
  if (box_end == 0) return;
  const std::size_t box_begin = place(std::lower_bound(row.xs.begin(), row.xs.end(), std::min({a.x, b.x, c.x})));

  const Vec3 line = row.query(0);  // sides depend on y and z alone
  const EdgeSide ab = edge_side(a, b, line), bc = edge_side(b, c, line), ca = edge_side(c, a, line);
  const int ties = ab.tie + bc.tie + ca.tie;
  degenerate[box_end] += ties;

  const int sigma = ab.sign;
  if (sigma == 0 || bc.sign != sigma || ca.sign != sigma) {
    // Not crossed, but where the line meets the closed triangle samples may lie on it.
    if (ties > 0) mark_on_surface(a, b, c, row, box_begin, box_end);
    return;
  }
  const auto ahead = [&](double x) { return plane_side(a, b, c, {x, row.y, row.z}) == -sigma; };
  const auto first = row.xs.begin() + static_cast<std::ptrdiff_t>(box_begin);
  const auto last = row.xs.begin() + static_cast<std::ptrdiff_t>(box_end);
  std::size_t end = place(std::partition_point(first, last, ahead));
  crossings[end] += sigma;
  for (; end < box_end && plane_side(a, b, c, row.query(end)) == 0; ++end) on_surface[end] = 1;
}

void RowCrossings::mark_on_surface(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row, std::size_t begin,
                                   std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    if (!on_surface[i] && on_triangle(a, b, c, row.query(i))) on_surface[i] = 1;
  }
}

}  // namespace raycone
