// A cross-section of a field as a picture.
#pragma once

#include <span>

#include "app/picture/image.h"
#include "app/picture/plane_view.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Colours of winding numbers `values` at the pixels of `view`, row by row from the top, with contour lines at the
// half-integers, the curve where the plane cuts `mesh`, and a colour bar where `legend` is wanted and has room.
[[nodiscard]] Image slice_picture(const PlaneView& view, std::span<const double> values, const TriangleMesh& mesh,
                                  bool legend);

// Bytes per pixel that it takes, its result included.
inline constexpr double kSlicePictureBytes = 8 + 3 + 1 + 1 + 1;

}  // namespace raycone
