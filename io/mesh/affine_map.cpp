#include "io/mesh/affine_map.h"

#include <cmath>

namespace raycone {
namespace {

Vec3 turned(const AffineMap& map, const Vec3& v) { return v.x * map.x + v.y * map.y + v.z * map.z; }

// To a largest magnitude of about 1, without rounding: by a power of two.
Vec3 scaled_to_one(const Vec3& v) {
  const double largest = largest_coordinate(v);
  if (largest == 0.0 || !std::isfinite(largest)) return v;
  const int exponent = std::ilogb(largest);
  return {std::scalbn(v.x, -exponent), std::scalbn(v.y, -exponent), std::scalbn(v.z, -exponent)};
}

// Columns, and then rows, are scaled each by its own size, so that the product of tiny ones keeps its sign.
bool has_negative_determinant(const AffineMap& map) {
  const Vec3 x = scaled_to_one(map.x), y = scaled_to_one(map.y), z = scaled_to_one(map.z);
  const auto row = [&](int i) { return scaled_to_one({x[i], y[i], z[i]}); };
  return dot(row(0), cross(row(1), row(2))) < 0.0;
}

}  // namespace

Vec3 transformed(const AffineMap& map, const Vec3& v) { return turned(map, v) + map.origin; }

AffineMap composed(const AffineMap& outer, const AffineMap& inner) {
  return {turned(outer, inner.x), turned(outer, inner.y), turned(outer, inner.z), transformed(outer, inner.origin),
          outer.mirrored != inner.mirrored};
}

AffineMap affine_map_of_matrix(std::span<const double> m) {
  AffineMap map{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
  map.mirrored = has_negative_determinant(map);
  return map;
}

AffineMap affine_map_of_parts(const Vec3& translation, std::span<const double> rotation, const Vec3& scale) {
  const double x = rotation[0], y = rotation[1], z = rotation[2], w = rotation[3];
  // Written in decimals, the quaternion is a unit one up to rounding only: dividing by its squared norm normalizes it.
  const double f = 2.0 / (x * x + y * y + z * z + w * w);
  AffineMap map;
  map.x = scale.x * Vec3{1.0 - f * (y * y + z * z), f * (x * y + z * w), f * (x * z - y * w)};
  map.y = scale.y * Vec3{f * (x * y - z * w), 1.0 - f * (x * x + z * z), f * (y * z + x * w)};
  map.z = scale.z * Vec3{f * (x * z + y * w), f * (y * z - x * w), 1.0 - f * (x * x + y * y)};
  map.origin = translation;
  map.mirrored = (scale.x < 0.0) != ((scale.y < 0.0) != (scale.z < 0.0));
  return map;
}

}  // namespace raycone
