#include "core/data/coordinate_precision.h"

#include <cmath>
#include <limits>

namespace raycone {

Vec3 rounded_to(CoordinatePrecision precision, const Vec3& p) {
  if (precision == CoordinatePrecision::kDouble) return p;
  // Volatile, since GCC 12.2 leaves some of several numbers out when it vectorizes this (-ftree-slp-vectorize).
  const auto rounded = [](double x) {
    const volatile auto single = static_cast<float>(x);
    return static_cast<double>(single);
  };
  return {rounded(p.x), rounded(p.y), rounded(p.z)};
}

void round_to(CoordinatePrecision precision, std::vector<Vec3>& points) {
  if (precision == CoordinatePrecision::kDouble) return;
  for (Vec3& p : points) p = rounded_to(precision, p);
}

Vec3 rounded_down_to(CoordinatePrecision precision, const Vec3& p) {
  if (precision == CoordinatePrecision::kDouble) return p;
  Vec3 result = rounded_to(precision, p);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(result[axis] > p[axis]) || std::isinf(result[axis])) continue;
    result[axis] = std::nextafter(static_cast<float>(result[axis]), -std::numeric_limits<float>::infinity());
  }
  return result;
}

void round_down_to(CoordinatePrecision precision, std::vector<Vec3>& points) {
  if (precision == CoordinatePrecision::kDouble) return;
  for (Vec3& p : points) p = rounded_down_to(precision, p);
}

}  // namespace raycone
