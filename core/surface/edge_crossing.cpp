#include "core/surface/edge_crossing.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/exact/predicates.h"
#include "core/mesh/triangle_runs.h"

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

// segment_hit() of segments whose ends are on these sides of the triangle's plane.
std::optional<double> hit_between(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c, int side_p,
                                  int side_q) {
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

}  // namespace

std::optional<double> segment_hit(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (!boxes_meet(p, q, a, b, c)) return std::nullopt;
  return hit_between(p, q, a, b, c, plane_side(a, b, c, p), plane_side(a, b, c, q));
}

void HitFinder::enter(const Vec3& end, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  end_ = end;
  triangles_.clear();
  for (const std::uint32_t triangle : triangles) {
    const Triangle& t = mesh.triangles[triangle];
    triangles_.push_back({&mesh.vertices[t[0]], &mesh.vertices[t[1]], &mesh.vertices[t[2]],
                          box_of_triangle(mesh, triangle), triangle, std::nullopt});
  }
}

void HitFinder::find(const Vec3& other, bool from_end, std::vector<SegmentHit>& hits) {
  hits.clear();
  const Vec3 lower{std::min(end_.x, other.x), std::min(end_.y, other.y), std::min(end_.z, other.z)};
  const Vec3 upper{std::max(end_.x, other.x), std::max(end_.y, other.y), std::max(end_.z, other.z)};
  for (Known& t : triangles_) {
    if (upper.x < t.box.lower.x || lower.x > t.box.upper.x || upper.y < t.box.lower.y || lower.y > t.box.upper.y ||
        upper.z < t.box.lower.z || lower.z > t.box.upper.z) {
      continue;
    }
    if (!t.side) t.side = plane_side(*t.a, *t.b, *t.c, end_);
    const int side = plane_side(*t.a, *t.b, *t.c, other);
    const auto hit = from_end ? hit_between(end_, other, *t.a, *t.b, *t.c, *t.side, side)
                              : hit_between(other, end_, *t.a, *t.b, *t.c, side, *t.side);
    if (hit) hits.push_back({*hit, t.triangle});
  }
  if (hits.size() > 1)
    std::ranges::sort(hits, {}, [](const SegmentHit& hit) { return std::tuple(hit.at, hit.triangle); });
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const LongVec3 n = long_normal(a, b, c);
  const Long length = std::sqrt(long_dot(n, n));
  if (!(length > 0)) return {};
  return {static_cast<double>(n.x / length), static_cast<double>(n.y / length), static_cast<double>(n.z / length)};
}

}  // namespace raycone
