// Marching squares (William E. Lorensen and Harvey E. Cline's cubes in the plane), with the mean of the corners to
// decide where opposite corners are on one side.
#include "app/picture/contours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "app/picture/clip.h"

namespace raycone {
namespace {

// A corner of a square, in order around it.
struct Corner {
  PicturePoint point;
  double value;
};
using Square = std::array<Corner, 4>;

// Where the side behind corner `side` has the value `level`. Precondition: its ends are on either side of it.
PicturePoint crossing(const Square& square, std::size_t side, double level) {
  const Corner& a = square[side];
  const Corner& b = square[(side + 1) % 4];
  const double t = (level - a.value) / (b.value - a.value);
  return {a.point.x + t * (b.point.x - a.point.x), a.point.y + t * (b.point.y - a.point.y)};
}

void trace(const Square& square, double level, const std::function<void(const PictureSegment& piece)>& line) {
  std::array<std::size_t, 4> crossed{};
  std::size_t count = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    if ((square[side].value < level) != (square[(side + 1) % 4].value < level)) crossed[count++] = side;
  }
  const auto connect = [&](std::size_t a, std::size_t b) {
    line({crossing(square, crossed[a], level), crossing(square, crossed[b], level)});
  };
  if (count == 2) connect(0, 1);
  if (count < 4) return;
  const double mean = (square[0].value + square[1].value + square[2].value + square[3].value) / 4.0;
  const bool corner_0_is_cut_off = (mean < level) != (square[0].value < level);
  connect(0, corner_0_is_cut_off ? 3 : 1);
  connect(corner_0_is_cut_off ? 1 : 2, corner_0_is_cut_off ? 2 : 3);
}

void trace_all_levels(const Square& square, const Levels& levels,
                      const std::function<void(const PictureSegment&)>& line) {
  constexpr double kMost = 16;  // lines in a square of a pixel; more are none, and may be millions
  const auto [least, most] = std::ranges::minmax(square, {}, &Corner::value);
  if (most.value - least.value > kMost * levels.step) return;
  for (double n = std::floor((least.value - levels.offset) / levels.step) + 1.0;; n += 1.0) {
    const double level = levels.offset + n * levels.step;
    if (!(level <= most.value)) return;
    trace(square, level, line);
  }
}

}  // namespace

Raster<std::uint8_t> squares_on(std::span<const PictureSegment> curve, std::int64_t width, std::int64_t height) {
  // A curve exactly through pixel centres is on the squares at either side, whichever way it was rounded.
  constexpr double kRoundingSlack = 1e-3;
  Raster<std::uint8_t> squares(std::max<std::int64_t>(width - 1, 1), std::max<std::int64_t>(height - 1, 1));
  for (const PictureSegment& segment : curve) {
    // Coordinates in which squares are what pixels are to clip.h.
    const PictureSegment moved{{segment.a.x - 0.5, segment.a.y - 0.5}, {segment.b.x - 0.5, segment.b.y - 0.5}};
    const auto clipped = clip(moved, squares.width(), squares.height(), 1.0);
    if (!clipped) continue;
    const auto [top, bottom] = std::minmax(clipped->a.y, clipped->b.y);
    const IndexRange rows = pixels_within(top - kRoundingSlack, bottom + kRoundingSlack, squares.height());
    for (std::int64_t row = rows.begin; row < rows.end; ++row) {
      const auto y = static_cast<double>(row);
      const auto [left, right] = x_extent(*clipped, y - kRoundingSlack, y + 1.0 + kRoundingSlack);
      const IndexRange columns = pixels_within(left - kRoundingSlack, right + kRoundingSlack, squares.width());
      for (std::int64_t column = columns.begin; column < columns.end; ++column) squares.at(column, row) = 1;
    }
  }
  return squares;
}

void trace_contours(std::span<const double> values, std::int64_t width, std::int64_t height,
                    const Raster<std::uint8_t>& cut, const Levels& levels,
                    const std::function<void(const PictureSegment& piece)>& line) {
  const auto corner = [&](std::int64_t column, std::int64_t row) {
    return Corner{{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5},
                  values[static_cast<std::size_t>(row * width + column)]};
  };
  for (std::int64_t row = 0; row + 1 < height; ++row) {
    for (std::int64_t column = 0; column + 1 < width; ++column) {
      if (cut.at(column, row) != 0) continue;
      trace_all_levels(
          {corner(column, row), corner(column + 1, row), corner(column + 1, row + 1), corner(column, row + 1)}, levels,
          line);
    }
  }
}

}  // namespace raycone
