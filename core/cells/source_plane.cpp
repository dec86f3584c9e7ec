#include "core/cells/source_plane.h"

#include <cmath>
#include <cstddef>

#include "core/cells/unit_normal.h"

namespace raycone {

SourcePlane source_plane(const TriangleMesh& input, std::int32_t source) {
  const Triangle& t = input.triangles[static_cast<std::size_t>(source)];
  const Vec3 &a = input.vertices[t[0]], &b = input.vertices[t[1]], &c = input.vertices[t[2]];
  return {a, unit_normal(a, b, c), source};
}

bool is_same_plane(const SourcePlane& a, const SourcePlane& b, const Vec3& near, double off) {
  constexpr double kSame = 1 - 1e-10;  // cosine
  return std::abs(dot(a.normal, b.normal)) >= kSame && std::abs(a.height(near)) <= off &&
         std::abs(b.height(near)) <= off;
}

std::optional<Vec3> meeting_point(std::span<const SourcePlane> planes, const Vec3& near) {
  constexpr double kLeast = 1e-2;  // determinant of normals: below, the planes hardly have a point in common
  if (planes.size() != 2 && planes.size() != 3) return std::nullopt;
  const Vec3 &a = planes[0].normal, &b = planes[1].normal;
  const double of_a = -planes[0].height(near), of_b = -planes[1].height(near);
  if (planes.size() == 2) {
    const double k = dot(a, b), rest = 1 - k * k;
    return near + ((of_a - k * of_b) / rest) * a + ((of_b - k * of_a) / rest) * b;
  }
  const Vec3& c = planes[2].normal;
  const double of_c = -planes[2].height(near), determinant = dot(a, cross(b, c));
  if (!(std::abs(determinant) >= kLeast)) return std::nullopt;
  return near + (of_a / determinant) * cross(b, c) + (of_b / determinant) * cross(c, a) +
         (of_c / determinant) * cross(a, b);
}

}  // namespace raycone
