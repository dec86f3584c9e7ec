// Which pixels a segment concerns.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "app/picture/image.h"

namespace raycone {

// Half-open.
struct IndexRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

// The part of `segment` that is within `margin` of the picture; nothing where there is none, or it is not finite.
[[nodiscard]] std::optional<PictureSegment> clip(const PictureSegment& segment, std::int64_t width, std::int64_t height,
                                                 double margin);

// The pixels [i, i + 1] of 0 <= i < count that meet [from, to].
[[nodiscard]] IndexRange pixels_within(double from, double to, std::int64_t count);

// Least and largest x of the part of `segment` with top <= y <= bottom. Precondition: there is such a part.
[[nodiscard]] std::pair<double, double> x_extent(const PictureSegment& segment, double top, double bottom);

}  // namespace raycone
