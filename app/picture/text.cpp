#include "app/picture/text.h"

#include <cmath>
#include <numbers>

#include "app/picture/glyphs.h"

namespace raycone {
namespace {

constexpr double kGap = 0.18;           // between glyphs
constexpr double kStrokeWidth = 0.125;  // all in units of the height
constexpr double kDegreesPerPiece = 10.0;

Polyline polyline_of(const GlyphArc& arc) {
  const int pieces = static_cast<int>(std::ceil(std::abs(arc.end - arc.begin) / kDegreesPerPiece));
  Polyline line;
  for (int i = 0; i <= pieces; ++i) {
    const double angle = (arc.begin + (arc.end - arc.begin) * i / pieces) * std::numbers::pi / 180.0;
    line.push_back({arc.x + arc.rx * std::cos(angle), arc.y + arc.ry * std::sin(angle)});
  }
  return line;
}

void add_polyline(Coverage& coverage, const Polyline& line, double left, double baseline, double height) {
  const auto placed = [&](const PicturePoint& p) { return PicturePoint{left + height * p.x, baseline - height * p.y}; };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    add_stroke(coverage, {placed(line[i]), placed(line[i + 1])}, kStrokeWidth * height);
  }
}

}  // namespace

double text_width(std::string_view text, double height) {
  double width = text.empty() ? 0.0 : -kGap;
  for (const char character : text) width += glyph_of(character).width + kGap;
  return width * height;
}

void add_text(Coverage& coverage, std::string_view text, double left, double baseline, double height) {
  for (const char character : text) {
    const Glyph& glyph = glyph_of(character);
    for (const Polyline& line : glyph.lines) add_polyline(coverage, line, left, baseline, height);
    for (const GlyphArc& arc : glyph.arcs) add_polyline(coverage, polyline_of(arc), left, baseline, height);
    left += (glyph.width + kGap) * height;
  }
}

}  // namespace raycone
