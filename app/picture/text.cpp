// Glyphs are polylines and arcs of ellipses in a square of side 1, y up from the baseline.
#include "app/picture/text.h"

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace raycone {
namespace {

struct Arc {
  double x, y;        // centre
  double rx, ry;      // radii
  double begin, end;  // degrees, counter-clockwise if rising
};

using Polyline = std::vector<PicturePoint>;

struct Glyph {
  double width = 0.3;
  std::vector<Polyline> lines = {};
  std::vector<Arc> arcs = {};
};

const std::map<char, Glyph>& glyphs() {
  static const std::map<char, Glyph> all{
      {'0', {0.6, {}, {{0.3, 0.5, 0.27, 0.5, 0, 360}}}},
      {'1', {0.6, {{{0.1, 0.78}, {0.36, 1}, {0.36, 0}}}, {}}},
      {'2', {0.6, {{{0.51, 0.57}, {0.03, 0}, {0.57, 0}}}, {{0.29, 0.725, 0.265, 0.275, 165, -34}}}},
      {'3', {0.6, {}, {{0.28, 0.76, 0.24, 0.24, 150, -90}, {0.28, 0.26, 0.28, 0.26, 90, -150}}}},
      {'4', {0.6, {{{0.44, 0}, {0.44, 1}, {0.02, 0.3}, {0.58, 0.3}}}, {}}},
      {'5', {0.6, {{{0.52, 1}, {0.11, 1}, {0.06, 0.53}}}, {{0.28, 0.32, 0.29, 0.32, 139, -148}}}},
      {'6', {0.6, {}, {{0.3, 0.31, 0.27, 0.31, 0, 360}, {0.56, 0.31, 0.53, 0.69, 180, 100}}}},
      {'7', {0.6, {{{0.03, 1}, {0.57, 1}, {0.2, 0}}}, {}}},
      {'8', {0.6, {}, {{0.3, 0.76, 0.23, 0.24, 0, 360}, {0.3, 0.26, 0.275, 0.26, 0, 360}}}},
      {'9', {0.6, {}, {{0.3, 0.69, 0.27, 0.31, 0, 360}, {0.04, 0.69, 0.53, 0.69, 0, -80}}}},
      {'-', {0.6, {{{0.08, 0.45}, {0.52, 0.45}}}, {}}},
      {'.', {0.24, {{{0.12, 0.02}, {0.12, 0.02}}}, {}}},
      {'+', {0.6, {{{0.08, 0.45}, {0.52, 0.45}}, {{0.3, 0.23}, {0.3, 0.67}}}, {}}},
      {'d', {0.55, {{{0.5, 1}, {0.5, 0}}}, {{0.27, 0.33, 0.23, 0.33, 0, 360}}}},
      {'e', {0.55, {{{0.03, 0.34}, {0.51, 0.34}}}, {{0.27, 0.33, 0.24, 0.33, 0, 315}}}},
      {'f', {0.4, {{{0.15, 0}, {0.15, 0.8}}, {{0, 0.64}, {0.36, 0.64}}}, {{0.35, 0.8, 0.2, 0.2, 180, 80}}}},
      {'i', {0.2, {{{0.1, 0}, {0.1, 0.66}}, {{0.1, 0.93}, {0.1, 0.93}}}, {}}},
      {'n', {0.55, {{{0.06, 0}, {0.06, 0.66}}, {{0.5, 0}, {0.5, 0.44}}}, {{0.28, 0.44, 0.22, 0.22, 0, 180}}}},
      {'o', {0.56, {}, {{0.28, 0.33, 0.25, 0.33, 0, 360}}}},
      {'s', {0.5, {}, {{0.25, 0.495, 0.19, 0.165, 40, 270}, {0.25, 0.165, 0.21, 0.165, 90, -140}}}},
      {'t', {0.4, {{{0.15, 0.9}, {0.15, 0.17}}, {{0, 0.64}, {0.36, 0.64}}}, {{0.32, 0.17, 0.17, 0.17, 180, 275}}}},
      {'u', {0.55, {{{0.05, 0.66}, {0.05, 0.22}}, {{0.49, 0.66}, {0.49, 0}}}, {{0.27, 0.22, 0.22, 0.22, 180, 360}}}},
      {'v', {0.55, {{{0.03, 0.66}, {0.27, 0}, {0.52, 0.66}}}, {}}},
      {'x', {0.5, {{{0.03, 0.66}, {0.47, 0}}, {{0.03, 0}, {0.47, 0.66}}}, {}}},
      {'y', {0.52, {{{0.03, 0.66}, {0.27, 0}}, {{0.5, 0.66}, {0.14, -0.3}}}, {}}},
      {'z', {0.5, {{{0.03, 0.66}, {0.46, 0.66}, {0.03, 0}, {0.48, 0}}}, {}}},
      {'w', {0.9, {{{0.04, 0.66}, {0.24, 0}, {0.45, 0.6}, {0.66, 0}, {0.86, 0.66}}}, {}}}};
  return all;
}

constexpr double kGap = 0.18;           // between glyphs
constexpr double kStrokeWidth = 0.125;  // all in units of the height
constexpr double kDegreesPerPiece = 10.0;

Polyline polyline_of(const Arc& arc) {
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

Glyph glyph_of(char character) {
  const auto found = glyphs().find(character);
  return found == glyphs().end() ? Glyph{} : found->second;
}

}  // namespace

double text_width(std::string_view text, double height) {
  double width = text.empty() ? 0.0 : -kGap;
  for (const char character : text) width += glyph_of(character).width + kGap;
  return width * height;
}

void add_text(Coverage& coverage, std::string_view text, double left, double baseline, double height) {
  for (const char character : text) {
    const Glyph glyph = glyph_of(character);
    for (const Polyline& line : glyph.lines) add_polyline(coverage, line, left, baseline, height);
    for (const Arc& arc : glyph.arcs) add_polyline(coverage, polyline_of(arc), left, baseline, height);
    left += (glyph.width + kGap) * height;
  }
}

}  // namespace raycone
