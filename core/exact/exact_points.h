// Points with exact coordinates: corners of a mesh, and where lines and planes through them meet.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// Points are known by their numbers, in the order in which they were added; equal ones have one number. Their
// coordinates are fractions of integers of any size: nothing is ever rounded but what rounded() returns. Seen along an
// axis, against its direction, the next axis (cyclically) points to the right and the one after it up. Axes are 0 to 2.
// Const functions are thread-safe. Needs DefaultFloatingPoint.
class ExactPoints {
 public:
  using Number = std::uint32_t;

  // A point, where the line through two vertices meets the plane through three others. Precondition: it does in one.
  struct OnPlane {
    Vec3 from, to;
    Corners3 plane;
  };
  // A point, where from -> to crosses left -> right. Precondition: they are in one plane, seen along `axis`, and cross.
  struct Crossing {
    int axis;
    Number from, to, left, right;
  };

  // For a mesh whose used vertices are below 2^1020 in magnitude.
  explicit ExactPoints(const TriangleMesh& mesh);
  ExactPoints(ExactPoints&&) noexcept;
  ExactPoints& operator=(ExactPoints&&) noexcept;
  ~ExactPoints();

  [[nodiscard]] Number size() const;
  // The nearest doubles, or one beside them where these are subnormal. Equal points give the same doubles, and rounding
  // keeps the order of coordinates.
  [[nodiscard]] const Vec3& rounded(Number point) const;

  // A used vertex of the mesh.
  Number add(const Vec3& vertex);
  // The numbers of many points, the same as if added one after the other. Computes them on the threads that ThreadLimit
  // allows.
  std::vector<Number> add(std::span<const OnPlane> points);
  std::vector<Number> add(std::span<const Crossing> points);
  // The mean of three points, weighted. Precondition: the sum of the weights is not 0.
  Number add_between(const std::array<Number, 3>& points, const std::array<std::uint32_t, 3>& weights);
  // A triangle that has the whole mesh within it, seen along `axis`; counter-clockwise.
  std::array<Number, 3> add_triangle_around(int axis);

  // 1 where a, b, c turn left, seen along an axis; -1 where they turn right, 0 where they are on a line.
  [[nodiscard]] int turn(int axis, Number a, Number b, Number c) const;
  // The same where a and b are vertices of the mesh.
  [[nodiscard]] int turn(int axis, const Vec3& a, const Vec3& b, Number c) const;
  // The axis along which most of the triangle is seen, as far as doubles tell; never one along which it is seen from
  // the side. Precondition: it has an area.
  [[nodiscard]] int axis_to_see(const std::array<Number, 3>& triangle) const;
  // 1 in front of a triangle of the mesh, -1 behind it, 0 in its plane.
  [[nodiscard]] int side(const Corners3& triangle, Number point) const;

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace raycone
