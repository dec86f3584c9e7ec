// Strokes are anti-aliased by the distance from pixel centre to segment, which suits curves of many short segments.
#include "app/picture/image.h"

#include <algorithm>
#include <cmath>

#include "app/picture/clip.h"

namespace raycone {
namespace {

double distance(const PicturePoint& p, const PictureSegment& segment) {
  const double dx = segment.b.x - segment.a.x;
  const double dy = segment.b.y - segment.a.y;
  const double length_squared = dx * dx + dy * dy;
  const double along = (p.x - segment.a.x) * dx + (p.y - segment.a.y) * dy;
  const double t = length_squared > 0.0 ? std::clamp(along / length_squared, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - segment.a.x - t * dx, p.y - segment.a.y - t * dy);
}

// `distance`: from the pixel's centre to the shape's border, positive outside.
void cover(std::uint8_t& pixel, double distance) {
  const double part = std::clamp(0.5 - distance, 0.0, 1.0);
  pixel = std::max(pixel, static_cast<std::uint8_t>(std::lround(255.0 * part)));
}

std::uint8_t mixed(std::uint8_t below, std::uint8_t above, double part) {
  return static_cast<std::uint8_t>(std::lround(below + part * (above - below)));
}

}  // namespace

void add_stroke(Coverage& coverage, const PictureSegment& segment, double width) {
  const double reach = width / 2 + 0.5;
  const auto clipped = clip(segment, coverage.width(), coverage.height(), reach);
  if (!clipped) return;
  const IndexRange rows = pixels_within(std::min(clipped->a.y, clipped->b.y) - reach,
                                        std::max(clipped->a.y, clipped->b.y) + reach, coverage.height());
  for (std::int64_t row = rows.begin; row < rows.end; ++row) {
    const double y = static_cast<double>(row) + 0.5;
    const auto [left, right] = x_extent(*clipped, y - reach, y + reach);
    const IndexRange columns = pixels_within(left - reach, right + reach, coverage.width());
    for (std::int64_t column = columns.begin; column < columns.end; ++column) {
      const PicturePoint centre{static_cast<double>(column) + 0.5, y};
      cover(coverage.at(column, row), distance(centre, *clipped) - width / 2);
    }
  }
}

void add_round_rectangle(Coverage& coverage, const PictureSegment& diagonal, double radius) {
  const PicturePoint middle{(diagonal.a.x + diagonal.b.x) / 2, (diagonal.a.y + diagonal.b.y) / 2};
  const double half_width = std::abs(diagonal.b.x - diagonal.a.x) / 2 - radius;
  const double half_height = std::abs(diagonal.b.y - diagonal.a.y) / 2 - radius;
  for (std::int64_t row = 0; row < coverage.height(); ++row) {
    for (std::int64_t column = 0; column < coverage.width(); ++column) {
      const double dx = std::abs(static_cast<double>(column) + 0.5 - middle.x) - half_width;
      const double dy = std::abs(static_cast<double>(row) + 0.5 - middle.y) - half_height;
      const double outside = std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
      cover(coverage.at(column, row), outside + std::min(std::max(dx, dy), 0.0) - radius);
    }
  }
}

void blend(Image& image, const Coverage& coverage, const Rgb& colour, double opacity, PixelOffset offset) {
  for (std::int64_t row = 0; row < coverage.height(); ++row) {
    for (std::int64_t column = 0; column < coverage.width(); ++column) {
      const double part = opacity * coverage.at(column, row) / 255.0;
      if (part == 0.0) continue;
      Rgb& pixel = image.at(offset.column + column, offset.row + row);
      pixel = {mixed(pixel.red, colour.red, part), mixed(pixel.green, colour.green, part),
               mixed(pixel.blue, colour.blue, part)};
    }
  }
}

}  // namespace raycone
