#include "core/arrangement/contact.h"

#include <algorithm>
#include <cstddef>

#include "core/exact/predicates.h"

namespace raycone {
namespace {

using Sides = std::array<int, 3>;

Sides sides_of(const Corners3& corners, const Corners3& plane) {
  Sides sides{};
  std::ranges::transform(corners, sides.begin(),
                         [&](const Vec3& p) { return plane_side(plane[0], plane[1], plane[2], p); });
  return sides;
}

// Whether the line from a to b, which are on different sides of the triangle's plane, passes through the triangle.
bool passes_through(const Vec3& a, const Vec3& b, const Corners3& triangle) {
  bool is_left = true, is_right = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = plane_side(a, b, triangle[i], triangle[(i + 1) % 3]);
    is_left = is_left && side >= 0;
    is_right = is_right && side <= 0;
  }
  return is_left || is_right;
}

// Adds the points in which edges of `s` pass through `t`, and corners of `s` on `t`.
void add_ends(const Corners3& s, const Sides& sides, const Corners3& t, Contact& contact) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (sides[i] == 0 && on_triangle(t[0], t[1], t[2], s[i])) contact.corners.push_back(s[i]);
    if (sides[i] * sides[next] < 0 && passes_through(s[i], s[next], t)) contact.passes.push_back({s[i], s[next], t});
  }
}

}  // namespace

Contact contact_of(const Corners3& s, const Corners3& t) {
  const Sides of_s = sides_of(s, t);
  if (of_s == Sides{0, 0, 0}) return {true, {}, {}};
  Contact contact;
  add_ends(s, of_s, t, contact);
  add_ends(t, sides_of(t, s), s, contact);
  return contact;
}

}  // namespace raycone
