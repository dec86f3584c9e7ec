#include "core/mesh/normalize.h"

#include <algorithm>
#include <cmath>

namespace raycone {
namespace {

// Of the vertex farthest from `middle`. In units of the box, whose square is in range.
double radius_of(const TriangleMesh& mesh, const Vec3& middle, double unit) {
  double most = 0.0;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Vec3 from = mesh.vertices[corner] - middle;
      const Vec3 scaled{from.x / unit, from.y / unit, from.z / unit};
      most = std::max(most, dot(scaled, scaled));
    }
  }
  return std::sqrt(most);
}

}  // namespace

Normalization normalization_of(const TriangleMesh& mesh, const Normalize& normalize) {
  const Box box = bounding_box(mesh);
  const double side = longest_side(box);
  Normalization result{middle(box), normalize.size / side};
  if (normalize.to == NormalizeTo::kCube || !(side > 0.0) || !std::isfinite(side)) return result;
  result.factor = normalize.size / (2.0 * radius_of(mesh, result.middle, side)) / side;
  return result;
}

void apply(const Normalization& normalization, std::vector<Vec3>& vertices) {
  for (Vec3& vertex : vertices) vertex = normalization.factor * (vertex - normalization.middle);
}

}  // namespace raycone
