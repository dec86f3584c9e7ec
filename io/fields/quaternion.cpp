#include "io/fields/quaternion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raycone {
namespace {

// Less of its square is rounding of the other parts, in 32 bits.
constexpr double kNoRealPart = 1e-7;

float away_from_zero(double number) {
  const auto nearest = static_cast<float>(number);
  if (std::abs(static_cast<double>(nearest)) >= std::abs(number)) return nearest;
  return std::nextafter(nearest, std::copysign(2.0F, nearest));
}

}  // namespace

std::array<Vec3, 3> columns_of(const Quaternion& quaternion) {
  auto [b, c, d] = quaternion;
  const double square = b * b + c * c + d * d;
  double a = 0.0;
  if (1.0 - square >= kNoRealPart) {
    a = std::sqrt(1.0 - square);
  } else {
    const double length = std::sqrt(square);
    b /= length, c /= length, d /= length;
  }
  return {Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
          Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
          Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
}

// Shepperd (1978): the largest part from the diagonal, the others from it, so that no division magnifies rounding.
Quaternion quaternion_of(const std::array<Vec3, 3>& r) {
  const double trace = r[0].x + r[1].y + r[2].z;
  const std::array<double, 4> squares{trace, r[0].x, r[1].y, r[2].z};
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  // Four times the products of the parts with each other.
  const double ab = r[1].z - r[2].y, ac = r[2].x - r[0].z, ad = r[0].y - r[1].x;
  const double bc = r[0].y + r[1].x, bd = r[2].x + r[0].z, cd = r[1].z + r[2].y;
  const double square = largest == 0 ? 1.0 + trace : 1.0 + 2.0 * squares[largest] - trace;  // four times its own
  const std::array<std::array<double, 4>, 4> products{
      {{square, ab, ac, ad}, {ab, square, bc, bd}, {ac, bc, square, cd}, {ad, bd, cd, square}}};
  const auto& row = products[largest];
  const double scale = (row[0] < 0.0 ? -0.5 : 0.5) / std::sqrt(square);
  return {scale * row[1], scale * row[2], scale * row[3]};
}

// Where no real part is left, what rounding towards zero leaves would be taken for one, of up to 3e-4.
std::array<float, 3> stored_parts(const Quaternion& quaternion) {
  const auto [b, c, d] = quaternion;
  if (1.0 - (b * b + c * c + d * d) < kNoRealPart) return {away_from_zero(b), away_from_zero(c), away_from_zero(d)};
  return {static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)};
}

}  // namespace raycone
