#include "core/cells/unit_normal.h"

#include "core/exact/long_vec3.h"

namespace raycone {

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const LongVec3 n = long_normal(a, b, c);
  const long double length = norm(n);
  if (!(length > 0)) return {};
  return {static_cast<double>(n.x / length), static_cast<double>(n.y / length), static_cast<double>(n.z / length)};
}

}  // namespace raycone
