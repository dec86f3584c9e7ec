// Scaling by a power of two, which commutes with every rounding.
#pragma once

#include <array>
#include <cmath>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Multiplies by 2^exponent. Exact, unless the result is subnormal and drops bits, or overflows.
class PowerOfTwo {
 public:
  explicit PowerOfTwo(int exponent);
  [[nodiscard]] int exponent() const { return exponent_; }
  // Two factors whose product is 2^exponent, which itself need not be a double.
  [[nodiscard]] std::array<double, 2> factors() const { return {half_, other_half_}; }
  // Whether scaling `value` loses nothing that a predicate could see. False for all that becomes subnormal, even if it
  // would keep its bits: so along an axis of a lattice the answer changes only a few times. Overflow is not looked at.
  [[nodiscard]] bool keeps(double value) const { return std::abs(value) >= least_ || value == 0.0; }
  [[nodiscard]] double operator()(double value) const { return value * half_ * other_half_; }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return {(*this)(p.x), (*this)(p.y), (*this)(p.z)}; }

 private:
  int exponent_;
  double half_;  // two factors, since 2^exponent itself may not be a double
  double other_half_;
  double least_;  // magnitude, beside 0, that the product keeps
};

// e such that the largest coordinate of the triangles is in [2^(e-1), 2^e); 0 where all coordinates are zero.
[[nodiscard]] int largest_exponent(const TriangleMesh& mesh);

// The power of two that brings the largest coordinate of the triangles into [1/2, 1), so that products neither overflow
// nor leave the range of the predicates' filters; 2^0 where all coordinates are zero, or where a coordinate of a
// triangle would lose bits (a mesh that spans more than 2^1020: predicates are then slower, not wrong).
[[nodiscard]] PowerOfTwo unit_scale(const TriangleMesh& mesh);

}  // namespace raycone
