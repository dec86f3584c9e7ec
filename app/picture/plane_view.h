// The rectangle of a plane that a picture shows.
#pragma once

#include <cstdint>

#include "app/picture/image.h"
#include "core/data/vec3.h"

namespace raycone {

struct PlaneView {
  Vec3 corner;  // world position of the picture's lower left corner
  Vec3 right;   // orthonormal
  Vec3 up;
  Vec3 normal;         // right x up: towards the viewer
  Vec3 origin;         // axes that are none of the world's count from here
  double pixel = 1.0;  // side of a pixel, world units
  std::int64_t width = 1;
  std::int64_t height = 1;

  // The centre of a pixel, row 0 at the top.
  [[nodiscard]] Vec3 centre(std::int64_t column, std::int64_t row) const {
    return corner + ((static_cast<double>(column) + 0.5) * pixel) * right +
           ((static_cast<double>(height - 1 - row) + 0.5) * pixel) * up;
  }
  // Where the picture shows `point`, or its foot on the plane.
  [[nodiscard]] PicturePoint picture_point(const Vec3& point) const {
    const Vec3 from_corner = point - corner;
    return {dot(from_corner, right) / pixel, static_cast<double>(height) - dot(from_corner, up) / pixel};
  }
};

}  // namespace raycone
