#include "core/boundary/flat_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycone {
namespace {

// Of normals' products with differences, relative to the largest coordinate times a normal's magnitude (docs/method.md,
// "Rules on lattices"). Smaller pieces than kLeastLength have no plane: products would lose bits.
constexpr double kPlaneError = 0x1p-44;
constexpr double kLeastLength = 0x1p-200;
constexpr double kUnderflow = 0x1p-1022;  // more than products that underflow lose together

}  // namespace

FlatPiece FlatPiece::of_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Box& box) {
  const Vec3 ab = b - a, ac = c - a;
  const double length = std::max(largest_coordinate(ab), largest_coordinate(ac));
  if (!(length >= kLeastLength)) return {box, a, {}, 0.0};
  return {box, a, cross(ab, ac), length * length};
}

FlatPiece FlatPiece::cone_of(const Vec3& a, const Vec3& b) {
  Box box = box_of(a, b);
  box.lower.x = -std::numeric_limits<double>::infinity();
  const Vec3 ab = b - a;
  const double length = std::max(std::abs(ab.y), std::abs(ab.z));
  if (!(length >= kLeastLength)) return {box, a, {}, 0.0};
  return {box, a, {0.0, -ab.z, ab.y}, length};
}

bool FlatPiece::may_meet(const Box& other) const {
  if (!overlap(box_, other)) return false;
  const Vec3 to_middle = middle(other) - corner_, half = 0.5 * (other.upper - other.lower);
  const double reach = std::abs(normal_.x) * half.x + std::abs(normal_.y) * half.y + std::abs(normal_.z) * half.z;
  const double farthest = std::max(largest_coordinate(corner_), largest_coordinate(other));
  return !(std::abs(dot(normal_, to_middle)) > reach + (kPlaneError * farthest * magnitude_ + kUnderflow));
}

}  // namespace raycone
