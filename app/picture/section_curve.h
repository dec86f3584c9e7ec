// Where a plane cuts a mesh.
#pragma once

#include <vector>

#include "app/picture/image.h"
#include "app/picture/plane_view.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// A segment for each triangle that the plane of `view` cuts, in pixels of its picture; those outside of it too. Like
// the values beside it, the curve is that of the plane moved by an infinitesimal step towards +x (then +y, then +z):
// faces within the plane are on one side of it.
[[nodiscard]] std::vector<PictureSegment> section_curve(const TriangleMesh& mesh, const PlaneView& view);

}  // namespace raycone
