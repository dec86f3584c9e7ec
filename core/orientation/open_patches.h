// How open patches are turned.
#pragma once

#include <memory>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/surface_samples.h"

namespace raycone {

// Faces with a boundary, turned to agree.
struct OpenSurface {
  std::vector<Triangle> faces;
};

// Turns open surfaces beside closed ones. What does not depend on how the closed ones are turned is found once.
class OpenSurfaceTurner {
 public:
  // `surfaces`, not empty, and `vertices`, in_unit_box(), must outlive this. Uses the threads that ThreadLimit allows,
  // as turn() does.
  OpenSurfaceTurner(const std::vector<OpenSurface>& surfaces, const NumberedVertices& vertices);
  ~OpenSurfaceTurner();
  OpenSurfaceTurner(const OpenSurfaceTurner&) = delete;
  OpenSurfaceTurner& operator=(const OpenSurfaceTurner&) = delete;

  // For each open surface 1 where it stays as it is, -1 where it is reversed. `closed`: faces that stay as they are.
  // With these, the winding number on the open surfaces, as the mean of both sides of a face, should come closest to
  // 1/2: the sum of its squared distances from 1/2, weighted by area, is made small. docs/method.md, "Orientation",
  // says which samples stand for the surfaces and how the least sum is sought. Depends on coordinates only.
  // Precondition: `closed` are the same faces at each call, in any orientation.
  [[nodiscard]] std::vector<int> turn(const std::vector<Triangle>& closed);

 private:
  class Search;
  std::unique_ptr<Search> search_;
};

}  // namespace raycone
