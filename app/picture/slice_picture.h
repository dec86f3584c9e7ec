// A cross-section of a field as a picture.
#pragma once

#include <span>
#include <string>

#include "app/picture/image.h"
#include "app/picture/plane_view.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// What values are, which decides about colours, contours and legend.
enum class PictureField {
  kWinding,   // contours at the half-integers
  kInside,    // 0 or 1
  kDistance,  // signed, negative inside; contours at round distances
  kLabel,     // whole numbers; no contours
};

// Values at the pixels of a view, row by row from the top.
struct PictureValues {
  PictureField field;
  std::span<const double> values;
  std::span<const std::string> names = {};   // of labels, from 1
  std::span<const std::string> titles = {};  // the first one that there is room for is above a framed picture
};

enum class PictureFrame {
  kNone,
  kAxesAndLegend,  // around the picture, where there is room for them (framed_picture.h)
};

// Their colours, with contour lines and the curve where the plane cuts `mesh`.
[[nodiscard]] Image slice_picture(const PlaneView& view, const PictureValues& values, const TriangleMesh& mesh,
                                  PictureFrame frame);

// An upper bound of the bytes that it takes, its result included.
[[nodiscard]] double slice_picture_bytes(const PlaneView& view, PictureFrame frame);

}  // namespace raycone
