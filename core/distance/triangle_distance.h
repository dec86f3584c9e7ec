// The distance from a point to a triangle.
#pragma once

#include <array>

#include "core/data/vec3.h"

namespace raycone {

// How far squared() may be off, and more: the square of a distance is below this wherever the result of squared() is
// not above `square`.
inline constexpr double kBeyondErrorFactor = 1 + 1e-8, kBeyondErrorTerm = 1e-19;
[[nodiscard]] inline double beyond_error(double square) { return square * kBeyondErrorFactor + kBeyondErrorTerm; }

// A triangle prepared for distances to many points. It may be degenerate: a segment or a point.
class TriangleDistance {
 public:
  TriangleDistance(const Vec3& a, const Vec3& b, const Vec3& c);

  // The square of the distance from p to the closed triangle. The distance is off by less than 1e-12 of itself or by
  // less than 4 u (u = 2^-53) times the largest coordinate of the mesh or p, if the mesh's largest coordinate is in
  // [1/2, 1] and those of p are below 2^400 (docs/method.md, "Distances").
  [[nodiscard]] double squared(const Vec3& p) const;

 private:
  friend struct TrianglePack;  // has the same numbers in columns

  enum class Shape {
    kProper,   // its height is a sixteenth of its longest edge or more
    kSlender,  // 2e-4 or more
    kFlat,     // a segment or a point, from some distance
  };

  // The square of the distance to the edge that starts at corner i.
  [[nodiscard]] double squared_to_edge(std::size_t i, const Vec3& p) const;
  // The same as squared(), for the closest points of which squared() cannot be sure.
  [[nodiscard]] double squared_with_care(const Vec3& p) const;

  std::array<Vec3, 3> corners_;
  std::array<Vec3, 3> edges_;             // edge i from corner i to the next
  std::array<double, 3> inverse_square_;  // of the edges' lengths; 0 for a point
  Vec3 to_v_, to_w_;                      // a + v ab + w ac is the closest point of the plane, v = (p - a) . to_v_
  double sure_from_;                      // squares from here on need no care,
  double sure_up_to_;                     // nor those that are not above this
  double direction_from_;                 // from here on the closest point's direction is off by less than 2e-6
  Shape shape_;
};

}  // namespace raycone
