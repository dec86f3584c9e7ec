#include "core/data/single_precision.h"

namespace raycone {

Vec3 rounded_to_float(const Vec3& p) {
  // Volatile, since GCC 12.2 leaves some of several numbers out when it vectorizes this (-ftree-slp-vectorize).
  const auto rounded = [](double x) {
    const volatile auto single = static_cast<float>(x);
    return static_cast<double>(single);
  };
  return {rounded(p.x), rounded(p.y), rounded(p.z)};
}

void round_to_float(std::vector<Vec3>& points) {
  for (Vec3& p : points) p = rounded_to_float(p);
}

}  // namespace raycone
