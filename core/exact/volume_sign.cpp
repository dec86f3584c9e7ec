#include "core/exact/volume_sign.h"

#include <algorithm>
#include <cmath>

#include "core/exact/exact_integers.h"

namespace raycone {
namespace {

// Differences, two products and the sums round each term by less than (n + 16) u of its magnitude; twice that is
// trusted.
int sure_volume_sign(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  const Vec3 origin = vertices[triangles.front()[0]];
  constexpr double kUnderflow = 0x1p-1000;  // far more than a product loses that is below all doubles
  double sum = 0.0, terms = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - origin, b = vertices[t[1]] - origin, c = vertices[t[2]] - origin;
    sum += dot(a, cross(b, c));
    terms += std::abs(a.x) * (std::abs(b.y * c.z) + std::abs(b.z * c.y) + kUnderflow) +
             std::abs(a.y) * (std::abs(b.z * c.x) + std::abs(b.x * c.z) + kUnderflow) +
             std::abs(a.z) * (std::abs(b.x * c.y) + std::abs(b.y * c.x) + kUnderflow);
  }
  const double trust = (static_cast<double>(triangles.size()) + 16.0) * 0x1p-52 * terms + 0x1p-900;
  return static_cast<int>(sum > trust) - static_cast<int>(sum < -trust);  // neither where something overflows
}

}  // namespace

int volume_sign(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  if (triangles.empty()) return 0;
  if (const int sign = sure_volume_sign(triangles, vertices); sign != 0) return sign;
  int exponent = 0;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) {
      for (int axis = 0; axis < 3; ++axis) exponent = std::max(exponent, exact::exponent_to_integer(vertices[v][axis]));
    }
  }
  const auto integers = [&](std::uint32_t v) {
    const Vec3& p = vertices[v];
    return exact::IntegerVec3{exact::integer(p.x, exponent), exact::integer(p.y, exponent),
                              exact::integer(p.z, exponent)};
  };
  mpz_class sum = 0;
  for (const Triangle& t : triangles) sum += exact::dot(integers(t[0]), exact::cross(integers(t[1]), integers(t[2])));
  return sgn(sum);
}

}  // namespace raycone
