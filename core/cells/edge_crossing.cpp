#include "core/cells/edge_crossing.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/exact/exact_determinant.h"
#include "core/exact/place_at_plane.h"
#include "core/exact/predicates.h"
#include "core/exact/sure_sign.h"

namespace raycone {
namespace {

using Long = long double;

// The sign of a cross product of two differences times a third one, as far as that is sure; else 0. `terms`: the
// magnitudes of the products that `turn` has, added.
int sure_side(const Vec3& turn, const Vec3& terms, const Vec3& step) {
  constexpr double kTrust = 0x1p-48, kUnderflow = 0x1p-900;  // ten roundings are less
  constexpr Vec3 kTiny{0x1p-1000, 0x1p-1000, 0x1p-1000};     // more than what underflows in `turn`, times 2^48
  return sure_sign(dot(turn, step), kTrust * dot(terms + kTiny, absolute(step)) + kUnderflow);
}

// Of the line through p and q, which is not parallel to the triangle.
bool line_meets_triangle(const Vec3& p, const Vec3& q, const Corners3& triangle) {
  const auto& [a, b, c] = triangle;
  const int first = plane_side(p, q, a, b), second = plane_side(p, q, b, c);
  if (first * second < 0) return false;
  const int third = plane_side(p, q, c, a);
  return first * third >= 0 && second * third >= 0;
}

// Where a segment meets a plane that is so far from its ends: 0 at the first, 1 at the second.
double place_between(Long of_first, Long of_second) {
  const Long at = of_first / (of_first + of_second);
  return at >= 0 && at <= 1 ? static_cast<double>(at) : 0.5;  // 0 / 0, where a needle's normal underflows
}

// The same of p and q and the plane of a triangle. Where both are near to it, their distances are all rounding.
// `terms`: the magnitudes of the products that the distances, times the normal's length, have, added.
double place_between(Long of_p, Long of_q, double terms, const Vec3& p, const Vec3& q, const Corners3& triangle) {
  constexpr Long kUnderflow = 0x1p-900;  // far more than `terms` and the distances lose
  // Ten roundings of 2^-64, or of 2^-113, are below 2^-50 of the sum then.
  constexpr Long kSure = 0x1p-10;
  constexpr double kWideSure = 0x1p-58;
  const Long all_terms = terms + kUnderflow;
  if (of_p + of_q > kSure * all_terms) return place_between(of_p, of_q);
  const auto& [a, b, c] = triangle;
  const QuadVec3 normal = cross_of_differences(b, c, a);
  const Quad from_p = absolute(dot(normal, quad_difference(p, a))),
             from_q = absolute(dot(normal, quad_difference(q, a)));
  const Quad all = from_p + from_q;
  return all > kWideSure * Quad(all_terms) ? static_cast<double>(from_p / all) : place_at_plane(p, q, a, b, c);
}

double distance_terms(const Vec3& normal_terms, const Vec3& p, const Vec3& q, const Vec3& a) {
  return dot(normal_terms, absolute(p - a) + absolute(q - a));
}

}  // namespace

std::optional<double> segment_hit(const Vec3& p, const Vec3& q, const Corners3& triangle) {
  if (!overlap(box_of(p, q), box_of(triangle))) return std::nullopt;
  const auto& [a, b, c] = triangle;
  const int side_p = plane_side(a, b, c, p), side_q = plane_side(a, b, c, q);
  if (side_p == side_q) return std::nullopt;  // both 0, too
  if (side_p * side_q > 0 || !line_meets_triangle(p, q, triangle)) return std::nullopt;
  if (side_p == 0) return 0.0;
  if (side_q == 0) return 1.0;
  const LongVec3 normal = long_normal(a, b, c);
  return place_between(std::abs(dot(normal, long_difference(p, a))), std::abs(dot(normal, long_difference(q, a))),
                       distance_terms(cross_terms(b - a, c - a), p, q, a), p, q, triangle);
}

void HitFinder::enter(const Vec3& end, std::span<const std::uint32_t> triangles) {
  end_ = end;
  count_ = 0;
  for (const std::uint32_t triangle : triangles) {
    if (count_ == triangles_.size()) triangles_.emplace_back();
    Known& known = triangles_[count_++];
    known.has_sides = known.has_distance = false;
    if (known.triangle == triangle) continue;
    known.corners = corners_of(mesh_, mesh_.triangles[triangle]);
    known.box = box_of(known.corners);
    known.triangle = triangle;
    known.has_plane = false;
  }
}

HitFinder::Turn HitFinder::turn_of(const Vec3& u, const Vec3& v) { return {cross(u, v), cross_terms(u, v)}; }

void HitFinder::find_plane(Known& t) {
  const auto& [a, b, c] = t.corners;
  t.normal = turn_of(b - a, c - a);
  t.long_normal = long_normal(a, b, c);
  t.has_plane = true;
}

void HitFinder::find_sides(Known& t) const {
  if (!t.has_plane) find_plane(t);
  const Vec3 a = t.corners[0] - end_, b = t.corners[1] - end_, c = t.corners[2] - end_;
  t.sides = {turn_of(a, b), turn_of(b, c), turn_of(c, a)};
  t.side = plane_side_of(t, end_);
  t.has_sides = true;
}

int HitFinder::plane_side_of(const Known& t, const Vec3& p) {
  const auto& [a, b, c] = t.corners;
  const int side = sure_side(t.normal.value, t.normal.terms, p - a);
  return side != 0 ? side : plane_side(a, b, c, p);
}

// Of the line through the end and another point, which is not parallel to the triangle.
HitFinder::Passage HitFinder::passage(const Known& t, const Vec3& other) const {
  const Vec3 step = other - end_;
  std::array<int, 3> sides;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    sides[n] = sure_side(t.sides[n].value, t.sides[n].terms, step);
    if (sides[n] == 0) sides[n] = plane_side(end_, other, t.corners[n], t.corners[(n + 1) % 3]);
  }
  if (sides[0] * sides[1] < 0 || sides[0] * sides[2] < 0 || sides[1] * sides[2] < 0) return Passage::kBeside;
  return sides[0] * sides[1] * sides[2] == 0 ? Passage::kAtSide : Passage::kInside;
}

std::optional<SegmentHit> HitFinder::hit(Known& t, const Vec3& other, Way way) const {
  if (!t.has_sides) find_sides(t);
  const int side = plane_side_of(t, other);
  if (side == t.side) return std::nullopt;  // both 0, too
  const Passage how = passage(t, other);
  if (how == Passage::kBeside) return std::nullopt;
  if (t.side == 0) return SegmentHit{way == Way::kFromEnd ? 0.0 : 1.0, t.triangle};
  if (side == 0) return SegmentHit{way == Way::kFromEnd ? 1.0 : 0.0, t.triangle};
  if (!t.has_distance) {
    t.of_end = std::abs(dot(t.long_normal, long_difference(end_, t.corners[0])));
    t.has_distance = true;
  }
  const Long of_other = std::abs(dot(t.long_normal, long_difference(other, t.corners[0])));
  const double terms = distance_terms(t.normal.terms, end_, other, t.corners[0]);
  const double at = way == Way::kFromEnd ? place_between(t.of_end, of_other, terms, end_, other, t.corners)
                                         : place_between(of_other, t.of_end, terms, other, end_, t.corners);
  const int behind = way == Way::kFromEnd ? side : t.side;  // of the plane, in front of which w is less by one
  return SegmentHit{at, t.triangle, static_cast<std::int8_t>(how == Passage::kInside ? -behind : 0)};
}

void HitFinder::find(const Vec3& other, Way way, std::vector<SegmentHit>& hits) {
  hits.clear();
  const Vec3 lower{std::min(end_.x, other.x), std::min(end_.y, other.y), std::min(end_.z, other.z)};
  const Vec3 upper{std::max(end_.x, other.x), std::max(end_.y, other.y), std::max(end_.z, other.z)};
  for (Known& t : std::span(triangles_).first(count_)) {
    if (upper.x < t.box.lower.x || lower.x > t.box.upper.x || upper.y < t.box.lower.y || lower.y > t.box.upper.y ||
        upper.z < t.box.lower.z || lower.z > t.box.upper.z) {
      continue;
    }
    if (const std::optional<SegmentHit> one = hit(t, other, way)) hits.push_back(*one);
  }
  if (hits.size() > 1)
    std::ranges::sort(hits, {}, [](const SegmentHit& hit) { return std::tuple(hit.at, hit.triangle); });
}

}  // namespace raycone
