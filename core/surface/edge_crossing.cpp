#include "core/surface/edge_crossing.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/exact/predicates.h"

namespace raycone {
namespace {

// 64 bits of mantissa, so that the differences below keep what doubles can store.
using Long = long double;
struct LongVec3 {
  Long x, y, z;
};

LongVec3 long_difference(const Vec3& a, const Vec3& b) {
  return {Long{a.x} - Long{b.x}, Long{a.y} - Long{b.y}, Long{a.z} - Long{b.z}};
}

LongVec3 long_cross(const LongVec3& a, const LongVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Long long_dot(const LongVec3& a, const LongVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

LongVec3 long_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return long_cross(long_difference(b, a), long_difference(c, a));
}

bool boxes_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
    if (std::max(p[axis], q[axis]) < low || std::min(p[axis], q[axis]) > high) return false;
  }
  return true;
}

// Of the line through p and q, which is not parallel to the triangle.
bool line_meets_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int first = plane_side(p, q, a, b), second = plane_side(p, q, b, c);
  if (first * second < 0) return false;
  const int third = plane_side(p, q, c, a);
  return first * third >= 0 && second * third >= 0;
}

}  // namespace

std::optional<double> segment_hit(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (!boxes_meet(p, q, a, b, c)) return std::nullopt;
  const int side_p = plane_side(a, b, c, p), side_q = plane_side(a, b, c, q);
  if (side_p == side_q) return std::nullopt;  // both 0, too
  if (side_p * side_q > 0 || !line_meets_triangle(p, q, a, b, c)) return std::nullopt;
  if (side_p == 0) return 0.0;
  if (side_q == 0) return 1.0;
  const LongVec3 normal = long_normal(a, b, c);
  const Long of_p = std::abs(long_dot(normal, long_difference(p, a)));
  const Long of_q = std::abs(long_dot(normal, long_difference(q, a)));
  const Long at = of_p / (of_p + of_q);
  return at >= 0 && at <= 1 ? static_cast<double>(at) : 0.5;  // 0 / 0, where a needle's normal underflows
}

void find_segment_hits(const Vec3& p, const Vec3& q, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                       std::vector<SegmentHit>& hits) {
  hits.clear();
  for (const std::uint32_t triangle : triangles) {
    const Triangle& t = mesh.triangles[triangle];
    const auto hit = segment_hit(p, q, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    if (hit) hits.push_back({*hit, triangle});
  }
  std::ranges::sort(hits, {}, [](const SegmentHit& hit) { return std::tuple(hit.at, hit.triangle); });
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const LongVec3 n = long_normal(a, b, c);
  const Long length = std::sqrt(long_dot(n, n));
  if (!(length > 0)) return {};
  return {static_cast<double>(n.x / length), static_cast<double>(n.y / length), static_cast<double>(n.z / length)};
}

}  // namespace raycone
