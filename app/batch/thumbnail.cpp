// BMP needs no library, and its four bits a pixel are small enough to be kept by the thousand. Format: Microsoft,
// "Bitmap Storage".
#include "app/batch/thumbnail.h"

#include <algorithm>
#include <cmath>

namespace raycone {
namespace {

constexpr std::int64_t kMaxSide = 64;
constexpr int kColours = 16;

// From -0.5 to 1.5; 0 and 1 get colours of their own, 0.5 lies between the palest two.
std::uint8_t colour_of(double winding_number) {
  const double position = std::clamp((winding_number + 0.5) / 2.0, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(position * (kColours - 1)));
}

void append_number(std::string& bytes, std::uint32_t number, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFF);
}

// Blue below one half, red above, pale in the middle.
std::string palette() {
  constexpr std::array kBlue{0x14, 0x4B, 0x8C};
  constexpr std::array kRed{0xA6, 0x1E, 0x22};
  constexpr int kWhite = 0xF7;
  std::string bytes;
  for (int i = 0; i < kColours; ++i) {
    const double distance = std::abs(2.0 * i / (kColours - 1) - 1.0);
    const std::array<int, 3>& end = 2 * i < kColours ? kBlue : kRed;
    for (const std::size_t channel : {std::size_t{2}, std::size_t{1}, std::size_t{0}}) {
      bytes += static_cast<char>(std::lround(kWhite + distance * (end[channel] - kWhite)));
    }
    bytes += '\0';
  }
  return bytes;
}

std::string bmp_header(std::int64_t width, std::int64_t height, std::size_t pixel_bytes) {
  constexpr std::uint32_t kFileHeader = 14;
  constexpr std::uint32_t kInfoHeader = 40;
  constexpr std::uint32_t kPixels = kFileHeader + kInfoHeader + 4 * kColours;
  std::string bytes = "BM";
  append_number(bytes, kPixels + static_cast<std::uint32_t>(pixel_bytes), 4);
  append_number(bytes, 0, 4);
  append_number(bytes, kPixels, 4);
  append_number(bytes, kInfoHeader, 4);
  append_number(bytes, static_cast<std::uint32_t>(width), 4);
  append_number(bytes, static_cast<std::uint32_t>(height), 4);
  append_number(bytes, 1, 2);  // plane
  append_number(bytes, 4, 2);  // bits a pixel
  bytes.append(16, '\0');      // not compressed; no resolution
  append_number(bytes, kColours, 4);
  append_number(bytes, 0, 4);
  return bytes;
}

// The sample that pixel `n` of `pixels` shows, counted from 0.
std::int64_t sample_of(std::int64_t n, std::int64_t pixels, std::int64_t samples) {
  return (2 * n + 1) * samples / (2 * pixels);
}

}  // namespace

void Thumbnail::choose_layer(const Lattice& lattice) {
  const std::array<std::int64_t, 3>& counts = lattice.counts;
  across_ = 2;
  for (const std::size_t axis : {std::size_t{1}, std::size_t{0}}) {
    if (counts[axis] < counts[across_]) across_ = axis;
  }
  right_ = across_ == 0 ? 1 : 0;
  up_ = across_ == 2 ? 1 : 2;
  layer_ = lattice.index_min[across_] + counts[across_] / 2;
  const auto longest = static_cast<double>(std::max(counts[right_], counts[up_]));
  const double scale = std::min(1.0, kMaxSide / longest);
  const auto side = [scale](std::int64_t count) {
    return std::max<std::int64_t>(std::llround(static_cast<double>(count) * scale), 1);
  };
  width_ = side(counts[right_]);
  height_ = side(counts[up_]);
  colours_.assign(static_cast<std::size_t>(width_ * height_), 0);
}

void Thumbnail::add(const Lattice& lattice, const LatticeBlock& block, std::span<const double> values) {
  if (colours_.empty()) choose_layer(lattice);
  LatticeIndex shown{};
  shown[across_] = layer_;
  for (std::int64_t row = 0; row < height_; ++row) {
    shown[up_] = lattice.index_min[up_] + sample_of(row, height_, lattice.counts[up_]);
    for (std::int64_t column = 0; column < width_; ++column) {
      shown[right_] = lattice.index_min[right_] + sample_of(column, width_, lattice.counts[right_]);
      if (!block.holds(shown)) continue;
      colours_[static_cast<std::size_t>(row * width_ + column)] = colour_of(values[block.number_of(shown)]);
    }
  }
}

std::string Thumbnail::bmp() const {
  if (colours_.empty()) return "";
  std::string pixels;
  for (std::int64_t row = 0; row < height_; ++row) {
    const std::uint8_t* const colours = colours_.data() + row * width_;
    for (std::int64_t column = 0; column < width_; column += 2) {
      const int second = column + 1 < width_ ? colours[column + 1] : 0;
      pixels += static_cast<char>(colours[column] << 4 | second);
    }
    while (pixels.size() % 4 != 0) pixels += '\0';  // rows are whole words
  }
  return bmp_header(width_, height_, pixels.size()) + palette() + pixels;
}

}  // namespace raycone
