// What the colours of a picture mean.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/picture/colour_map.h"
#include "app/picture/image.h"
#include "app/picture/ticks.h"

namespace raycone {

// All colours, with numbers beside them.
struct LegendBar {
  ColourMap colours;
  std::vector<Tick> numbers;
  std::vector<double> lines;  // values at which the picture has contours
};

// One colour, and what it stands for; without a colour, only words.
struct LegendPatch {
  std::optional<Rgb> colour;
  std::string text;
};

struct Legend {
  std::string title;
  std::optional<LegendBar> bar;      // a bar or
  std::vector<LegendPatch> patches;  // one below the other
  std::string short_title = {};      // where there is no room for the other one
};

// How wide and high it is with digits of the height `text`, all in pixels, with its short title, for which there is
// room above 2.4 * text below its top.
struct LegendSize {
  std::int64_t width;
  std::int64_t height;
};
[[nodiscard]] LegendSize legend_size(const Legend& legend, double text);

// Draws it, without a title, from its top left corner. Precondition: it is within `image`.
void draw_legend(Image& image, const Legend& legend, double text, PixelOffset corner);

}  // namespace raycone
