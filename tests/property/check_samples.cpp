#include "tests/property/check_samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/data/rule.h"
#include "core/machine/floating_point.h"
#include "core/sampling/point_sampler.h"
#include "tests/support/exact_predicates.h"
#include "tests/support/quad_distance.h"

namespace raycone::test {
namespace {

TriangleMesh with_area(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices, {}};
  for (const Triangle& t : mesh.triangles) {
    if (!exactly_collinear(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]))
      result.triangles.push_back(t);
  }
  return result;
}

// On a triangle of which it is in the box, up to three products and two sums per coordinate.
bool lies_on(const TriangleMesh& mesh, double tolerance, const Vec3& p) {
  return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
    const TriangleMesh one{mesh.vertices, {t}};
    return contains(bounding_box(one), p) && quad_distance(one, p) <= tolerance;
  });
}

// floor(w + 1/2), which 113 bits hold exactly where w is a multiple of 2^-60; every other w is far from a half.
bool is_positive(double w) { return static_cast<__float128>(w) + 0.5 >= 1; }
bool is_nonzero(double w) { return is_positive(w) || static_cast<__float128>(w) + 0.5 < 0; }
bool is_odd(double w) {
  if (std::abs(w) >= 0x1p53) return false;  // even, as all doubles there
  const __float128 shifted = static_cast<__float128>(w) + 0.5;
  auto integer = static_cast<std::int64_t>(shifted);  // towards 0
  if (static_cast<__float128>(integer) > shifted) --integer;
  return integer % 2 != 0;
}

}  // namespace

std::optional<Failure> check_samples(const TriangleMesh& mesh, std::uint64_t seed, std::uint64_t count) {
  const DefaultFloatingPoint guard;
  const TriangleMesh surface = with_area(mesh);
  const Box box = bounding_box(mesh);
  const PointSampler sampler(mesh, box, {NearSamples{count, 0.0}, UniformSamples{count}}, seed);
  if (sampler.has_needed_area() == surface.triangles.empty())
    return Failure{{}, "an area, or none, where there is the other"};
  if (surface.triangles.empty()) return std::nullopt;
  constexpr double kNear = 1e300;  // to overflow
  if (!sampler.is_finite()) {
    if (largest_coordinate(bounding_box(surface)) < kNear)
      return Failure{{}, "said to overflow where nothing is that large"};
    return std::nullopt;
  }
  std::vector<Vec3> points(2 * count);
  sampler.draw(0, points);
  const double tolerance = 8 * 0x1p-53 * largest_coordinate(bounding_box(surface)) + 0x1p-1073;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!contains(box, points[i])) return Failure{points[i], "drawn out of the box"};
    if (i < count && !lies_on(surface, tolerance, points[i])) return Failure{points[i], "drawn off the surface"};
  }
  return std::nullopt;
}

std::optional<std::string> check_rules(double value) {
  for (const double w : {value, std::nextafter(value, HUGE_VAL), std::nextafter(value, -HUGE_VAL), -value}) {
    if (holds({RuleKind::kThreshold, value}, w) != (w >= value)) return "threshold";
    if (holds({RuleKind::kAbs, std::abs(value)}, w) != (w >= std::abs(value) || w <= -std::abs(value))) return "abs";
    if (holds({RuleKind::kPositive, 0.5}, w) != is_positive(w)) return "positive";
    if (holds({RuleKind::kNonzero, 0.5}, w) != is_nonzero(w)) return "nonzero";
    if (holds({RuleKind::kOdd, 0.5}, w) != is_odd(w)) return "odd";
  }
  return std::nullopt;
}

}  // namespace raycone::test
