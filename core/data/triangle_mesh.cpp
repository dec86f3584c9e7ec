#include "core/data/triangle_mesh.h"

namespace raycone {

Box bounding_box(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  Box box = empty_box();
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t v : triangle) extend(box, vertices[v]);
  }
  return box;
}

double area_of_triangle(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3& a = mesh.vertices[triangle[0]];
  return safe_norm(cross(mesh.vertices[triangle[1]] - a, mesh.vertices[triangle[2]] - a)) / 2.0;
}

double total_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) area += area_of_triangle(mesh, t);
  return area;
}

}  // namespace raycone
