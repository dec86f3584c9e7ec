// An axis-aligned box.
#pragma once

#include <algorithm>
#include <limits>

#include "core/data/vec3.h"

namespace raycone {

// A closed box.
struct Box {
  Vec3 lower;
  Vec3 upper;
};

// The box of no point: extended by something, it is the box of that.
inline Box empty_box() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

inline void extend(Box& box, const Box& by) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(box.lower[axis], by.lower[axis]);
    box.upper[axis] = std::max(box.upper[axis], by.upper[axis]);
  }
}
inline void extend(Box& box, const Vec3& p) { extend(box, Box{p, p}); }

inline Box hull(Box a, const Box& b) {
  extend(a, b);
  return a;
}

inline Box box_of(const Vec3& a, const Vec3& b) { return hull({a, a}, {b, b}); }
inline Box box_of(const Vec3& a, const Vec3& b, const Vec3& c) { return hull(box_of(a, b), {c, c}); }

// Without overflow.
inline double middle(const Box& box, int axis) { return box.lower[axis] / 2 + box.upper[axis] / 2; }
inline Vec3 middle(const Box& box) { return {middle(box, 0), middle(box, 1), middle(box, 2)}; }

// Of half the coordinates, whose differences do not overflow.
inline Box half_of(const Box& box) { return {0.5 * box.lower, 0.5 * box.upper}; }

inline double longest_side(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return std::max({size.x, size.y, size.z});
}

inline double square_of_diagonal(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return dot(size, size);
}

// Larger by as much on every side.
inline Box widened(const Box& box, double by) {
  const Vec3 margin{by, by, by};
  return {box.lower - margin, box.upper + margin};
}

// The largest magnitude of a coordinate of its points.
inline double largest_coordinate(const Box& box) {
  return std::max(largest_coordinate(box.lower), largest_coordinate(box.upper));
}

// The first of those along which it is longest.
inline int longest_axis(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

// Whether two boxes have a point in common; false where a coordinate is not a number.
inline bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis])) return false;
  }
  return true;
}

// Whether a box has all of another one, or a point.
inline bool contains(const Box& outer, const Box& inner) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(outer.lower[axis] <= inner.lower[axis] && inner.upper[axis] <= outer.upper[axis])) return false;
  }
  return true;
}
inline bool contains(const Box& box, const Vec3& p) { return contains(box, Box{p, p}); }

// Of the distance between two boxes, and between a box and a point, the square; 0 where they meet.
inline double square_of_gap(const Box& a, const Box& b) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double gap = std::max({a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis], 0.0});
    sum += gap * gap;
  }
  return sum;
}
inline double square_of_gap(const Box& box, const Vec3& p) { return square_of_gap(box, Box{p, p}); }

}  // namespace raycone
