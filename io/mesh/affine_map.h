// Affine maps of space, as scenes place their parts by them.
#pragma once

#include <span>

#include "core/data/vec3.h"

namespace raycone {

// Takes v to v.x x + v.y y + v.z z + origin.
struct AffineMap {
  Vec3 x{1, 0, 0};
  Vec3 y{0, 1, 0};
  Vec3 z{0, 0, 1};
  Vec3 origin;
  bool mirrored = false;  // negative determinant

  friend bool operator==(const AffineMap&, const AffineMap&) = default;
};

[[nodiscard]] Vec3 transformed(const AffineMap& map, const Vec3& v);

// First `inner`, then `outer`.
[[nodiscard]] AffineMap composed(const AffineMap& outer, const AffineMap& inner);

// Of 16 numbers, column after column; the last row is taken to be 0 0 0 1.
[[nodiscard]] AffineMap affine_map_of_matrix(std::span<const double> matrix);

// Scaled, then turned by the quaternion (x, y, z, w), then moved. Of its length, 2 over the square must be finite.
[[nodiscard]] AffineMap affine_map_of_parts(const Vec3& translation, std::span<const double> rotation,
                                            const Vec3& scale);

}  // namespace raycone
