// All coordinates are multiplied by one power of two that makes them integers. The square of a distance is then a
// quotient of integers: |a|^2 of a corner, |a x e|^2 / |e|^2 of an edge, (a . n)^2 / |n|^2 of a plane; and which of
// these counts is a matter of signs of integers.
#include "core/exact/direct_distance.h"

#include <quadmath.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/exact/exact_integers.h"
#include "core/exact/long_vec3.h"

namespace raycone {
namespace {

using namespace exact;

// Rounded towards zero: off by less than 2^-112.
Quad rounded(const mpz_class& z) {
  const auto bits = static_cast<int>(mpz_sizeinbase(z.get_mpz_t(), 2));
  const int dropped = std::max(bits - 113, 0);
  const mpz_class kept = z >> static_cast<mp_bitcnt_t>(dropped);
  const mpz_class high = kept >> 64, low = kept - (high << 64);
  const Quad digits = static_cast<Quad>(high.get_ui()) * 0x1p64 + static_cast<Quad>(low.get_ui());
  return ldexpq(digits, dropped);
}

Quad quotient(const mpz_class& numerator, const mpz_class& denominator) {
  return rounded(numerator) / rounded(denominator);
}

// The square of the distance from the origin to the segment.
Quad square_to_segment(const IntegerVec3& a, const IntegerVec3& b) {
  const IntegerVec3 edge = b - a;
  const mpz_class square = dot(edge, edge), along = -dot(a, edge);
  if (along <= 0) return rounded(dot(a, a));
  if (along >= square) return rounded(dot(b, b));
  const IntegerVec3 product = cross(a, edge);
  return quotient(dot(product, product), square);
}

// The square of the distance from the origin to the triangle.
Quad square_to_triangle(const Corners& corners) {
  const auto& [a, b, c] = corners;
  const IntegerVec3 normal = cross(b - a, c - a);
  const mpz_class square = dot(normal, normal);
  const auto inside_of = [&](const IntegerVec3& from, const IntegerVec3& to) {
    return dot(cross(from, to), normal) >= 0;
  };
  if (square > 0 && inside_of(a, b) && inside_of(b, c) && inside_of(c, a)) {
    const mpz_class height = dot(a, normal);
    return quotient(height * height, square);
  }
  return std::min({square_to_segment(a, b), square_to_segment(b, c), square_to_segment(c, a)});
}

using Points = std::array<Vec3, 3>;

Quad distance_to_triangle(const Points& points, const Vec3& q) {
  const ScaledTriangle triangle = as_integers(points, q);
  return ldexpq(sqrtq(square_to_triangle(triangle.corners)), -triangle.exponent);
}

// In 64 bits and with the exponents of 15 bits: off by less than 1e-18.
long double rough_square(const LongVec3& v) { return dot(v, v); }

long double rough_square_to_nearest_corner(const TriangleMesh& mesh, const Vec3& q) {
  long double least = HUGE_VALL;
  for (const Triangle& t : mesh.triangles) {
    for (const Vec3& p : corners_of(mesh, t)) least = std::min(least, rough_square(long_difference(p, q)));
  }
  return least;
}

long double rough_square_to_box(const Points& points, const Vec3& q) {
  std::array<long double, 3> outside{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({points[0][axis], points[1][axis], points[2][axis]});
    const long double below = static_cast<long double>(low) - q[axis], above = static_cast<long double>(q[axis]) - high;
    outside[static_cast<std::size_t>(axis)] = std::max({below, above, 0.0L});
  }
  return rough_square({outside[0], outside[1], outside[2]});
}

}  // namespace

Quad direct_distance(const TriangleMesh& mesh, const Vec3& q) {
  constexpr long double kMoreThanRounding = 1 + 1e-15L;
  long double limit = rough_square_to_nearest_corner(mesh, q) * kMoreThanRounding;
  Quad least = HUGE_VAL;
  for (const Triangle& t : mesh.triangles) {
    const Points points = corners_of(mesh, t);
    if (rough_square_to_box(points, q) > limit) continue;
    least = std::min(least, distance_to_triangle(points, q));
    const auto rounded = static_cast<long double>(least);
    limit = std::min(limit, rounded * rounded * kMoreThanRounding);
  }
  return least;
}

}  // namespace raycone
