#include "core/exact/projection.h"

#include <CGAL/Gmpzf.h>

#include <algorithm>
#include <cassert>
#include <climits>
#include <cstddef>
#include <utility>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

using Exact = CGAL::Gmpzf;  // sums and products of doubles
using ExactVec3 = std::array<Exact, 3>;

ExactVec3 exact(const Vec3& v) { return {Exact(v.x), Exact(v.y), Exact(v.z)}; }

ExactVec3 difference(const Vec3& a, const Vec3& b) {
  return {Exact(a.x) - Exact(b.x), Exact(a.y) - Exact(b.y), Exact(a.z) - Exact(b.z)};
}

ExactVec3 cross(const ExactVec3& a, const ExactVec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Of det(a, b, direction).
int determinant_sign(const ExactVec3& a, const ExactVec3& b, const Vec3& direction) {
  const ExactVec3 normal = cross(a, b), along = exact(direction);
  return static_cast<int>(CGAL::sign(normal[0] * along[0] + normal[1] * along[1] + normal[2] * along[2]));
}

// Whether floating point can tell that a - b is `difference` without an error (Knuth's two-sum).
bool is_exact_difference(double a, double b, double difference) {
  const double part = difference - a;
  return (a - (difference - part)) - (b + part) == 0.0;
}

// Whether floating point can tell that a b = c d: rounded products and what was rounded off are the same, and neither
// under- nor overflows.
bool is_same_product(double a, double b, double c, double d) {
  constexpr double kNoUnderflow = 0x1p-900;
  const double left = a * b, right = c * d;
  if ((a == 0.0 || b == 0.0) && (c == 0.0 || d == 0.0)) return true;
  return left == right && std::abs(left) > kNoUnderflow && std::isfinite(left) &&
         std::fma(a, b, -left) == std::fma(c, d, -right);
}

// Whether floating point can tell that three points lie on a line in space, as many corners do.
bool is_surely_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3;
    if (!is_exact_difference(b[axis], a[axis], u[axis]) || !is_exact_difference(c[axis], a[axis], v[axis]) ||
        !is_same_product(u[axis], v[next], u[next], v[axis]))
      return false;
  }
  return true;
}

Vec3 exact_area_direction(std::span<const Vec3> corners) {
  ExactVec3 area;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const ExactVec3 part = cross(difference(corners[i], corners[0]), difference(corners[i + 1], corners[0]));
    for (std::size_t axis = 0; axis < 3; ++axis) area[axis] += part[axis];
  }
  std::array<std::pair<double, long>, 3> parts;  // mantissa and exponent
  long largest = LONG_MIN;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    parts[axis] = area[axis].to_double_exp();
    if (parts[axis].first != 0.0) largest = std::max(largest, parts[axis].second + std::ilogb(parts[axis].first));
  }
  Vec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& [mantissa, exponent] = parts[static_cast<std::size_t>(axis)];
    if (mantissa != 0.0) direction[axis] = std::ldexp(mantissa, static_cast<int>(std::max(exponent - largest, -4000L)));
  }
  return direction;
}

double sum(const Vec3& v) { return v.x + v.y + v.z; }

}  // namespace

Vec3 area_direction(std::span<const Vec3> corners) {
  assert(DefaultFloatingPoint::holds());
  Vec3 area, terms;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 a = corners[i] - corners[0], b = corners[i + 1] - corners[0];
    area = area + cross(a, b);
    terms = terms + cross_terms(a, b);
  }
  // Each of the n sums and the four roundings behind a term are wrong by 2^-53 of all terms, so this is right to 2^-30.
  const double size = sum(absolute(area)), whole = sum(terms);
  const double needed = 0x1p-23 * static_cast<double>(corners.size() + 4) * whole;
  const bool sure = size > needed && size > kTurnUnderflow && std::isfinite(size);
  if (!sure) return exact_area_direction(corners);
  const int exponent = std::ilogb(largest_coordinate(area));
  return {std::ldexp(area.x, -exponent), std::ldexp(area.y, -exponent), std::ldexp(area.z, -exponent)};
}

int exact_side(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& v) {
  assert(DefaultFloatingPoint::holds());
  return determinant_sign(difference(b, a), exact(v), direction);
}

int exact_turn(const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c) {
  assert(DefaultFloatingPoint::holds());
  if (is_surely_collinear(a, b, c)) return 0;
  return determinant_sign(difference(b, a), difference(c, a), direction);
}

SweepOrder::SweepOrder(const Vec3& direction) : direction_(direction) {
  int along = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(direction[axis]) > std::abs(direction[along])) along = axis;
  int right = (along + 1) % 3, up = (along + 2) % 3;
  if (direction[along] < 0.0) std::swap(right, up);
  constexpr double kAskew = 0.3819660112501051;
  // v x along first, turned a quarter: det(v, up, direction) grows to the right, det(v, -right, direction) upwards.
  across_[0][up] = 1.0;
  across_[0][right] = -kAskew;
  across_[1][right] = -1.0;
  across_[1][up] = -kAskew;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    normal_[axis] = cross(across_[axis], direction);
    // So that what underflows here matters at no step's length.
    constexpr Vec3 kTiny{0x1p-1000, 0x1p-1000, 0x1p-1000};
    terms_[axis] = cross_terms(across_[axis], direction) + kTiny;
  }
}

}  // namespace raycone
