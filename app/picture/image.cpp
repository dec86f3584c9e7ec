// Strokes are anti-aliased by the distance from pixel centre to segment, which suits curves of many short segments.
#include "app/picture/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

std::uint8_t rounded(double channel) { return static_cast<std::uint8_t>(std::lround(std::min(channel, 255.0))); }

// What a pixel adds to one of fewer pixels along a side.
struct Share {
  std::int64_t from;
  std::int64_t to;
  double part;
};

// By rising `to`.
std::vector<Share> shares_of(std::int64_t count, std::int64_t fewer) {
  std::vector<Share> shares;
  const double scale = static_cast<double>(fewer) / static_cast<double>(count);
  for (std::int64_t from = 0; from < count; ++from) {
    // In integers, so that a border of either is never on the wrong side by rounding.
    const std::int64_t to = from * fewer / count;
    const std::int64_t behind = (from + 1) * fewer - (to + 1) * count;  // in units of 1 / count
    const double over = behind > 0 ? static_cast<double>(behind) / static_cast<double>(count) : 0.0;
    shares.push_back({from, to, scale - over});
    if (over > 0.0) shares.push_back({from, to + 1, over});
  }
  return shares;
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

Image shrunk(const Image& image, std::int64_t width, std::int64_t height) {
  const std::vector<Share> columns = shares_of(image.width(), width);
  const std::vector<Share> rows = shares_of(image.height(), height);
  Image result(width, height);
  std::vector<std::array<double, 3>> sums(static_cast<std::size_t>(width));
  const auto add_row = [&](const Share& row) {
    for (const Share& share : columns) {
      const Rgb& pixel = image.at(share.from, row.from);
      const double part = share.part * row.part;
      std::array<double, 3>& sum = sums[static_cast<std::size_t>(share.to)];
      sum = {sum[0] + part * pixel.red, sum[1] + part * pixel.green, sum[2] + part * pixel.blue};
    }
  };
  for (std::size_t n = 0; n < rows.size(); ++n) {
    add_row(rows[n]);
    if (n + 1 < rows.size() && rows[n + 1].to == rows[n].to) continue;
    for (std::int64_t at = 0; at < width; ++at) {
      std::array<double, 3>& sum = sums[static_cast<std::size_t>(at)];
      result.at(at, rows[n].to) = {rounded(sum[0]), rounded(sum[1]), rounded(sum[2])};
      sum = {};
    }
  }
  return result;
}

void paste(Image& image, const Image& part, PixelOffset offset) {
  for (std::int64_t row = 0; row < part.height(); ++row) {
    for (std::int64_t column = 0; column < part.width(); ++column) {
      image.at(offset.column + column, offset.row + row) = part.at(column, row);
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
