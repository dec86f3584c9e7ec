#include "app/picture/section_curve.h"

#include <array>

namespace raycone {
namespace {

// Whether a vertex exactly in the plane counts as in front of it, where the plane moves as samples do.
bool in_front_if_in_plane(const Vec3& normal) {
  for (int axis = 0; axis < 3; ++axis) {
    if (normal[axis] != 0.0) return normal[axis] < 0.0;
  }
  return false;
}

// A vertex as the plane has it.
struct VertexAtPlane {
  Vec3 position;
  double distance;  // positive in front
  bool in_front;
};

PicturePoint crossing(const VertexAtPlane& a, const VertexAtPlane& b, const PlaneView& view) {
  const double t = a.distance / (a.distance - b.distance);
  return view.picture_point(a.position + t * (b.position - a.position));
}

}  // namespace

std::vector<PictureSegment> section_curve(const TriangleMesh& mesh, const PlaneView& view) {
  const bool tie = in_front_if_in_plane(view.normal);
  std::vector<PictureSegment> curve;
  for (const Triangle& triangle : mesh.triangles) {
    std::array<VertexAtPlane, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 position = mesh.vertices[triangle[k]];
      const double distance = dot(view.normal, position - view.corner);
      corners[k] = {position, distance, distance > 0.0 || (distance == 0.0 && tie)};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexAtPlane& alone = corners[k];
      const VertexAtPlane& next = corners[(k + 1) % 3];
      const VertexAtPlane& last = corners[(k + 2) % 3];
      if (alone.in_front == next.in_front || alone.in_front == last.in_front) continue;
      curve.push_back({crossing(alone, next, view), crossing(alone, last, view)});
    }
  }
  return curve;
}

}  // namespace raycone
