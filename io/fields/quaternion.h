// Rotations as NIfTI-1 stores them, by method 2 of nifti1.h: unit quaternions whose real part is not negative.
#pragma once

#include <array>

#include "core/data/vec3.h"

namespace raycone {

// The imaginary parts; the real part follows from them.
struct Quaternion {
  double b = 0.0;
  double c = 0.0;
  double d = 0.0;
};

// The columns of the rotation. Where the parts leave less than 1e-7 of the square to the real part, there is none, as
// in nifti1_io.c.
[[nodiscard]] std::array<Vec3, 3> columns_of(const Quaternion& quaternion);

// Right to rounding, as the columns are a rotation.
[[nodiscard]] Quaternion quaternion_of(const std::array<Vec3, 3>& columns);

// As files keep it.
[[nodiscard]] std::array<float, 3> stored_parts(const Quaternion& quaternion);

}  // namespace raycone
