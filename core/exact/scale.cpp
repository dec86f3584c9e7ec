#include "core/exact/scale.h"

#include <algorithm>
#include <cmath>

namespace raycone {

PowerOfTwo::PowerOfTwo(int exponent)
    : exponent_(exponent),
      half_(std::ldexp(1.0, exponent / 2)),
      other_half_(std::ldexp(1.0, exponent - exponent / 2)) {}

int largest_exponent(const TriangleMesh& mesh) {
  double largest = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      const Vec3& p = mesh.vertices[v];
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent;
}

PowerOfTwo unit_scale(const TriangleMesh& mesh) {
  const int exponent = largest_exponent(mesh);
  const PowerOfTwo scale(-exponent);
  const PowerOfTwo inverse(exponent);
  if (exponent <= 0) return scale;  // scaling up loses nothing
  const auto exact = [&](double c) { return inverse(scale(c)) == c; };
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      const Vec3& p = mesh.vertices[v];
      if (!exact(p.x) || !exact(p.y) || !exact(p.z)) return PowerOfTwo(0);
    }
  }
  return scale;
}

}  // namespace raycone
