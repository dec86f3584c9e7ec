// Points that stand for surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/canonical_face.h"

namespace raycone {

// A point on a face, up to rounding.
struct SurfaceSample {
  Vec3 at;
  double weight = 0.0;  // the area that it stands for, positive
  CanonicalFace face;   // that it lies on
  int side = 0;         // where the perturbed point is (core/exact/predicates.h): 1 before the face, -1 behind it
};

// Vertices moved to where sums are taken. Each has a number, as if random, that depends on its moved coordinates alone.
// Once moved, small parts of a mesh may become one point: `exact` tells them apart then.
struct NumberedVertices {
  // `exact`: the vertices as they were; must outlive this.
  NumberedVertices(std::vector<Vec3> moved, const std::vector<Vec3>& exact);

  std::vector<Vec3> at;
  std::vector<std::uint64_t> number;
  const std::vector<Vec3>& exact;
};

// At most `count` samples, the middles of faces. Larger faces are taken rather than smaller ones: those whose area,
// divided by a number in (0, 1] that the corners' coordinates give, is largest (priority sampling; Duffield, Lund,
// Thorup 2007). Their order depends on coordinates only. None where all areas are 0. Uses the threads that ThreadLimit
// allows; needs DefaultFloatingPoint.
[[nodiscard]] std::vector<SurfaceSample> sample_surface(const std::vector<Triangle>& faces,
                                                        const NumberedVertices& vertices, std::size_t count);

// The samples in their order, but where a face has at least four times `area` (positive, square units): there the
// middles of 4, 9, 16, ... equal parts of the face, up to 1024, stand for it, none of less than `area` unless there
// would be more.
[[nodiscard]] std::vector<SurfaceSample> divided(const std::vector<SurfaceSample>& samples, double area);

}  // namespace raycone
