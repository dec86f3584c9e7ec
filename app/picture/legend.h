// What the colours of a picture mean.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/picture/colour_map.h"
#include "app/picture/image.h"
#include "app/picture/ticks.h"

namespace raycone {

struct Legend {
  std::string title;
  std::vector<Tick> labels;
  std::vector<double> lines;  // values at which the picture has contours
  bool continuous = true;     // a bar of all colours; else a patch for each label
};

// How wide and high it is with digits of the height `text`, all in pixels. Its bar begins 2.4 * text below its top.
struct LegendSize {
  std::int64_t width;
  std::int64_t height;
};
[[nodiscard]] LegendSize legend_size(const Legend& legend, double text);

// Draws it from its top left corner. Precondition: it is within `image`.
void draw_legend(Image& image, const Legend& legend, const ColourMap& colours, double text, PixelOffset corner);

}  // namespace raycone
