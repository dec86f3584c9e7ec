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

// Vertices moved to where sums are taken, each with a number that its coordinates there give, as if random. Moved,
// small parts of a mesh may become one point; where they were tells them apart then.
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

// Samples in place of these, whose order stays. Where a face is at least four times as large as `area`, they are the
// middles of 4, 9, 16, ... equal parts of it, up to 1024, each no smaller than that.
[[nodiscard]] std::vector<SurfaceSample> divided(const std::vector<SurfaceSample>& samples, double area);

}  // namespace raycone
