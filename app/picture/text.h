// Numbers, letters and signs, drawn as strokes so that they are sharp at any size.
#pragma once

#include <string_view>

#include "app/picture/image.h"

namespace raycone {

// Width of `text` drawn with digits `height` pixels high.
[[nodiscard]] double text_width(std::string_view text, double height);

// Draws `text` from `left` on the line that its digits stand on. What has no glyph (glyphs.h) is a blank.
void add_text(Coverage& coverage, std::string_view text, double left, double baseline, double height);

}  // namespace raycone
