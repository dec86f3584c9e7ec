// How far a triangle is from a needle.
#pragma once

#include <algorithm>

#include "core/data/vec3.h"

namespace raycone {

// Twice the area over the square of the longest side: sqrt(3) / 2 where all sides are equal, towards 0 for needles, NaN
// for a point. shape_along() takes the area as seen along `normal`, of length 1: negative where the triangle's back is
// seen.
[[nodiscard]] inline double shape_along(const Vec3& normal, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = v - u;
  return dot(cross(u, v), normal) / std::max({dot(u, u), dot(v, v), dot(w, w)});
}
[[nodiscard]] inline double shape_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = v - u;
  return norm(cross(u, v)) / std::max({dot(u, u), dot(v, v), dot(w, w)});
}

}  // namespace raycone
