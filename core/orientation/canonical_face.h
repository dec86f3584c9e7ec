// What tells faces apart, whatever their order, their corners' order and their orientation in a file.
#pragma once

#include <compare>
#include <utility>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

struct CanonicalFace {
  Corners3 corners;  // in lexicographic order
  int sign = 1;      // 1: the face runs around them in this order; -1: the other way round

  friend std::strong_ordering operator<=>(const CanonicalFace& a, const CanonicalFace& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (const auto order = lexicographic_order(a.corners[i], b.corners[i]); order != 0) return order;
    }
    return std::strong_ordering::equal;
  }
};

[[nodiscard]] inline CanonicalFace canonical_face(const Triangle& t, const std::vector<Vec3>& vertices) {
  CanonicalFace face{corners_of(vertices, t), 1};
  const auto sort_pair = [&](std::size_t i, std::size_t j) {
    if (lexicographic_order(face.corners[i], face.corners[j]) <= 0) return;
    std::swap(face.corners[i], face.corners[j]);
    face.sign = -face.sign;
  };
  sort_pair(0, 1);
  sort_pair(1, 2);
  sort_pair(0, 1);
  return face;
}

// The first of several faces. Precondition: there is one.
[[nodiscard]] inline CanonicalFace first_canonical_face(const std::vector<Triangle>& faces,
                                                        const std::vector<Vec3>& vertices) {
  CanonicalFace first = canonical_face(faces.front(), vertices);
  for (const Triangle& t : faces) {
    // Nearly none begins as far in front.
    const double x = first.corners[0].x;
    if (vertices[t[0]].x > x && vertices[t[1]].x > x && vertices[t[2]].x > x) continue;
    const CanonicalFace face = canonical_face(t, vertices);
    if (face < first) first = face;
  }
  return first;
}

}  // namespace raycone
