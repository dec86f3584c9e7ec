#include "core/orientation/unit_box.h"

#include <algorithm>
#include <cmath>

#include "core/exact/scale.h"

namespace raycone {

std::vector<Vec3> in_unit_box(const std::vector<Vec3>& vertices,
                              const std::vector<const std::vector<Triangle>*>& faces) {
  Box box = empty_box();
  for (const std::vector<Triangle>* part : faces) {
    for (const Triangle& t : *part) {
      for (const std::uint32_t v : t) extend(box, vertices[v]);
    }
  }
  double size = 0.0;  // a quarter of it, which cannot overflow
  for (int axis = 0; axis < 3; ++axis) size = std::max(size, 0.25 * box.upper[axis] - 0.25 * box.lower[axis]);
  int exponent = 0;
  std::frexp(size, &exponent);
  const PowerOfTwo scale(-exponent);
  const Vec3 corner = 0.25 * box.lower;
  std::vector<Vec3> moved;
  moved.reserve(vertices.size());
  for (const Vec3& p : vertices) moved.push_back(scale(0.25 * p - corner));
  return moved;
}

}  // namespace raycone
