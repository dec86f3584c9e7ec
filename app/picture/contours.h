// Contour lines of sampled values.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "app/picture/image.h"

namespace raycone {

// Squares between the centres of four neighbouring pixels, 1 where `curve` passes: (width - 1) x (height - 1), at least
// 1 x 1.
[[nodiscard]] Raster<std::uint8_t> squares_on(std::span<const PictureSegment> curve, std::int64_t width,
                                              std::int64_t height);

// offset + n * step for all integers n. Precondition: step > 0.
struct Levels {
  double offset = 0.5;
  double step = 1.0;
};

// The lines where the values (row by row from the top, at pixel centres) have one of the levels. Values jump at the
// surface: the squares `cut` by it have no contour; nor have those that more than sixteen levels would fill. `line` is
// called with each piece.
void trace_contours(std::span<const double> values, std::int64_t width, std::int64_t height,
                    const Raster<std::uint8_t>& cut, const Levels& levels,
                    const std::function<void(const PictureSegment& piece)>& line);

}  // namespace raycone
