// The shapes of characters: polylines and arcs of ellipses in a square of side 1, y up from the baseline.
#pragma once

#include <vector>

#include "app/picture/image.h"

namespace raycone {

struct GlyphArc {
  double x, y;        // centre
  double rx, ry;      // radii
  double begin, end;  // degrees, counter-clockwise if rising
};

using Polyline = std::vector<PicturePoint>;

struct Glyph {
  double width = 0.3;
  std::vector<Polyline> lines = {};
  std::vector<GlyphArc> arcs = {};
};

// Of digits, letters of ASCII and some signs; a blank for any other byte.
[[nodiscard]] const Glyph& glyph_of(char character);

}  // namespace raycone
