#include "core/exact/place_at_plane.h"

#include <algorithm>
#include <cmath>

#include "core/exact/exact_integers.h"

namespace raycone {

double place_at_plane(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  int exponent = 0;
  for (const Vec3& v : {p, q, a, b, c}) exponent = std::max(exponent, exact::exponent_to_integers(v));
  const exact::IntegerVec3 origin = exact::integers(a, exponent);
  const auto from_a = [&](const Vec3& v) { return exact::integers(v, exponent) - origin; };
  const exact::IntegerVec3 normal = cross(from_a(b), from_a(c));
  const mpz_class of_p = abs(dot(normal, from_a(p))), of_q = abs(dot(normal, from_a(q)));
  constexpr int kBits = 64;
  const mpz_class place = (of_p << kBits) / (of_p + of_q);
  return std::ldexp(place.get_d(), -kBits);
}

}  // namespace raycone
