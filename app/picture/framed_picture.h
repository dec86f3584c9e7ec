// A picture with axes and legend around it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "app/picture/image.h"
#include "app/picture/legend.h"
#include "app/picture/plane_view.h"

namespace raycone {

// Smaller pictures would have more frame than picture: they get none.
inline constexpr std::int64_t kLeastFramedSize = 320;  // pixels along the longer side

[[nodiscard]] bool has_frame(const PlaneView& view);

// Of digits, in pixels.
[[nodiscard]] double text_height(const PlaneView& view);

// `plot`, of `view`, shrunk so that axes and legend fit around it on a page whose longer side is that of `plot`. An
// axis of the world is labelled x, y or z and has world coordinates; another one u (to the right) or v (up), the
// distance from the view's origin in world units. Preconditions: has_frame(view), and the legend takes at most half of
// the longer side across, all of it upwards. The first of `titles` that there is room for is above the plot.
[[nodiscard]] Image framed_picture(const Image& plot, const PlaneView& view, const Legend& legend,
                                   std::span<const std::string> titles = {});

// An upper bound of the bytes that it takes, its result included.
[[nodiscard]] double framed_picture_bytes(const PlaneView& view);

}  // namespace raycone
