// Pieces of planes, and whether they may come into a box.
#pragma once

#include "core/data/box.h"

namespace raycone {

// Within a box and a plane. Thread-safe.
class FlatPiece {
 public:
  // The piece of the triangle that is in `box`.
  [[nodiscard]] static FlatPiece of_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Box& box);

  // All points from which a ray meets the edge ab.
  [[nodiscard]] static FlatPiece cone_of(const Vec3& a, const Vec3& b);

  [[nodiscard]] const Box& box() const { return box_; }

  // False only where no point of the piece is in the other box, the closed one. Rounding is on the safe side.
  [[nodiscard]] bool may_meet(const Box& other) const;

 private:
  FlatPiece(const Box& box, const Vec3& corner, const Vec3& normal, double magnitude)
      : box_(box), corner_(corner), normal_(normal), magnitude_(magnitude) {}

  Box box_;
  Vec3 corner_, normal_;  // of the plane
  double magnitude_;      // normals round by some units in the last place of this
};

}  // namespace raycone
