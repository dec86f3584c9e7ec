// An RGB picture and what is drawn into it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycone {

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

inline constexpr Rgb kInk{24, 24, 28};  // of curves and numbers

// In pixels: x to the right, y down, the top left corner of the picture is (0, 0), the centre of its first pixel
// (0.5, 0.5).
struct PicturePoint {
  double x = 0.0;
  double y = 0.0;
};

struct PictureSegment {
  PicturePoint a;
  PicturePoint b;
};

// Row by row from the top.
template <typename Pixel>
class Raster {
 public:
  Raster(std::int64_t width, std::int64_t height, Pixel fill = {})
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width * height), fill) {}

  [[nodiscard]] std::int64_t width() const { return width_; }
  [[nodiscard]] std::int64_t height() const { return height_; }
  [[nodiscard]] Pixel& at(std::int64_t column, std::int64_t row) { return pixels_[index(column, row)]; }
  [[nodiscard]] const Pixel& at(std::int64_t column, std::int64_t row) const { return pixels_[index(column, row)]; }
  [[nodiscard]] std::span<const Pixel> pixels() const { return pixels_; }
  [[nodiscard]] std::span<Pixel> pixels() { return pixels_; }

 private:
  [[nodiscard]] std::size_t index(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * width_ + column);
  }

  std::int64_t width_;
  std::int64_t height_;
  std::vector<Pixel> pixels_;
};

using Image = Raster<Rgb>;

// How much of each pixel is covered: 0 to 255. Overlapping strokes of one coverage do not darken each other.
using Coverage = Raster<std::uint8_t>;

// Adds a stroke of the given width with round ends. Parts outside are clipped; what is not finite is left out.
void add_stroke(Coverage& coverage, const PictureSegment& segment, double width);

// Where a smaller picture lies in a larger one: the place of its top left pixel.
struct PixelOffset {
  std::int64_t column = 0;
  std::int64_t row = 0;
};

// Each pixel of the result is the mean of what it covers of `image`. Precondition: neither side grows.
[[nodiscard]] Image shrunk(const Image& image, std::int64_t width, std::int64_t height);

// Precondition: `part` at `offset` is within `image`.
void paste(Image& image, const Image& part, PixelOffset offset);

// `opacity`: 0 to 1, of the colour where it covers fully. Precondition: `coverage` at `offset` is within the image.
void blend(Image& image, const Coverage& coverage, const Rgb& colour, double opacity = 1.0, PixelOffset offset = {});

}  // namespace raycone
