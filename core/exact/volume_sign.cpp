#include "core/exact/volume_sign.h"

#include <algorithm>
#include <cmath>

#include "core/exact/exact_integers.h"
#include "core/exact/sure_sign.h"

namespace raycone {
namespace {

int sign_in_doubles(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  constexpr Vec3 kUnderflow{kVolumeUnderflow, kVolumeUnderflow, kVolumeUnderflow};
  const Vec3 origin = vertices[triangles.front()[0]];
  double sum = 0.0, terms = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - origin, b = vertices[t[1]] - origin, c = vertices[t[2]] - origin;
    sum += dot(a, cross(b, c));
    terms += dot(absolute(a), cross_terms(b, c) + kUnderflow);
  }
  return sure_volume_sign(sum, terms, triangles.size());
}

}  // namespace

// Differences, products and the sums round each term by less than (n + 16) u of its magnitude; twice that is
// trusted.
int sure_volume_sign(double sum, double terms, std::uint64_t triangles) {
  const double trust = (static_cast<double>(triangles) + 16.0) * 0x1p-52 * terms + 0x1p-900;
  return sure_sign(sum, trust);  // 0 where something overflows
}

int volume_sign(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  if (triangles.empty()) return 0;
  if (const int sign = sign_in_doubles(triangles, vertices); sign != 0) return sign;
  int exponent = 0;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) exponent = std::max(exponent, exact::exponent_to_integers(vertices[v]));
  }
  const auto integers = [&](std::uint32_t v) { return exact::integers(vertices[v], exponent); };
  mpz_class sum = 0;
  for (const Triangle& t : triangles) sum += dot(integers(t[0]), cross(integers(t[1]), integers(t[2])));
  return sgn(sum);
}

}  // namespace raycone
