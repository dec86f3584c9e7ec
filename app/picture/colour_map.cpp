// OKLab: Bjorn Ottosson, "A perceptual color space for image processing" (2020).
#include "app/picture/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycone {
namespace {

// At the centre and at the ends.
constexpr double kLightest = 0.97;
constexpr double kDarkest = 0.37;

// The strongest colour, part of the way out. sRGB holds these chromas at these hues and lightnesses.
constexpr double kMostChroma = 0.14;
constexpr double kPositionOfMostChroma = 0.62;

constexpr double kHueOutside = 248.0;  // degrees: blue
constexpr double kHueInside = 35.0;    // red

constexpr std::size_t kColours = 4097;  // an odd number has the centre among them

// One value in this many may be beyond the range.
constexpr std::size_t kOutliersPer = 200;

std::uint8_t srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
}

double cubed(double x) { return x * x * x; }

Rgb from_oklab(double lightness, double a, double b) {
  const double l = cubed(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cubed(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cubed(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {srgb(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          srgb(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          srgb(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// `position`: from -1, farthest outside, to 1.
Rgb colour_at(double position) {
  const double outwards = std::abs(position);
  const double lightness = kLightest + (kDarkest - kLightest) * outwards;
  const double from_most = (outwards - kPositionOfMostChroma) / kPositionOfMostChroma;
  const double chroma = kMostChroma * (1.0 - from_most * from_most);
  const double hue = (position < 0.0 ? kHueOutside : kHueInside) * std::numbers::pi / 180.0;
  return from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
}

}  // namespace

ColourRange colour_range(std::span<const double> values) {
  std::vector<double> distances(values.size());
  std::ranges::transform(values, distances.begin(), [](double w) { return std::abs(w - ColourRange{}.centre); });
  const std::size_t outliers = distances.size() / kOutliersPer;
  const auto kept = distances.end() - 1 - static_cast<std::ptrdiff_t>(outliers);
  std::ranges::nth_element(distances, kept);
  // Rounding of values that are integers but for an error in their last digits must not widen the range.
  constexpr double kRoundingSlack = 1e-6;
  ColourRange range;
  range.half_width = std::max(1.0, std::ceil(2.0 * (*kept - kRoundingSlack)) / 2.0);
  const auto [least, most] = std::ranges::minmax(values);
  range.exceeded_below = least < range.least() - kRoundingSlack;
  range.exceeded_above = most > range.most() + kRoundingSlack;
  return range;
}

ColourRange distance_colour_range(std::span<const double> distances) {
  double largest = 0.0;
  for (const double distance : distances) {
    if (std::isfinite(distance)) largest = std::max(largest, std::abs(distance));
  }
  return {.centre = 0.0, .half_width = largest > 0.0 ? largest : 1.0, .inside_below = true};
}

ColourMap::ColourMap(const ColourRange& range) : range_(range), colours_(kColours) {
  for (std::size_t i = 0; i < kColours; ++i) {
    colours_[i] = colour_at(2.0 * static_cast<double>(i) / static_cast<double>(kColours - 1) - 1.0);
  }
}

Rgb ColourMap::operator()(double value) const {
  // From the centre: the whole range may be wider than the largest number.
  const double position = 0.5 + 0.5 * std::clamp((value - range_.centre) / range_.half_width, -1.0, 1.0);
  const double inwards = range_.inside_below ? 1.0 - position : position;
  return colours_[static_cast<std::size_t>(std::lround(inwards * static_cast<double>(kColours - 1)))];
}

}  // namespace raycone
