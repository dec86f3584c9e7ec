// How open patches are turned.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// Faces with a boundary, turned to agree.
struct OpenSurface {
  std::vector<Triangle> faces;
};

// For each open surface 1 where it stays as it is, -1 where it is reversed. With `closed`, faces that stay as they are,
// the winding number should come closest to 1/2 on the surfaces: as the mean of both sides of a face, squared distance
// from 1/2, weighted by area. docs/method.md, "Orientation", says which samples stand for the surfaces and how the
// least sum is sought. Depends on coordinates only. Uses the threads that ThreadLimit allows.
[[nodiscard]] std::vector<int> turn_open_surfaces(const std::vector<OpenSurface>& surfaces,
                                                  const std::vector<Triangle>& closed,
                                                  const std::vector<Vec3>& vertices);

}  // namespace raycone
