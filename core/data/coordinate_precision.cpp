#include "core/data/coordinate_precision.h"

#include <cmath>
#include <limits>

namespace raycone {

namespace {

// Volatile, since GCC 12.2 leaves some of several numbers out when it vectorizes this (-ftree-slp-vectorize).
double nearest_float(double x) {
  const volatile auto single = static_cast<float>(x);
  return static_cast<double>(single);
}

double float_not_above(double x) {
  const double nearest = nearest_float(x);
  if (!(nearest > x) || std::isinf(nearest)) return nearest;
  return std::nextafter(static_cast<float>(nearest), -std::numeric_limits<float>::infinity());
}

}  // namespace

Vec3 rounded_to(CoordinatePrecision precision, const Vec3& p) {
  if (precision == CoordinatePrecision::kDouble) return p;
  const auto rounded = precision == CoordinatePrecision::kSingle ? nearest_float : float_not_above;
  return {rounded(p.x), rounded(p.y), rounded(p.z)};
}

void round_to(CoordinatePrecision precision, std::vector<Vec3>& points) {
  if (precision == CoordinatePrecision::kDouble) return;
  for (Vec3& p : points) p = rounded_to(precision, p);
}

}  // namespace raycone
