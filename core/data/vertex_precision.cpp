#include "core/data/vertex_precision.h"

namespace raycone {

Vec3 rounded_to(VertexPrecision precision, const Vec3& p) {
  if (precision == VertexPrecision::kDouble) return p;
  // Volatile, since GCC 12.2 leaves some of several numbers out when it vectorizes this (-ftree-slp-vectorize).
  const auto rounded = [](double x) {
    const volatile auto single = static_cast<float>(x);
    return static_cast<double>(single);
  };
  return {rounded(p.x), rounded(p.y), rounded(p.z)};
}

void round_to(VertexPrecision precision, std::vector<Vec3>& points) {
  if (precision == VertexPrecision::kDouble) return;
  for (Vec3& p : points) p = rounded_to(precision, p);
}

}  // namespace raycone
