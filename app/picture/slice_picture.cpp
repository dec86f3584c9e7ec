#include "app/picture/slice_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/picture/colour_map.h"
#include "app/picture/contours.h"
#include "app/picture/framed_picture.h"
#include "app/picture/legend.h"
#include "app/picture/section_curve.h"
#include "app/picture/text.h"
#include "app/picture/ticks.h"
#include "io/fields/label_colour.h"

namespace raycone {
namespace {

// In a legend.
constexpr std::size_t kMostNumbers = 7;
constexpr double kMostContours = 14;
constexpr std::size_t kMostPatches = 30;
constexpr double kMostOfSide = 0.3;  // of the picture's longer side, that names are wide

// In pixels, of pictures of different sizes alike up to a lower limit.
struct LineWidths {
  double section;
  double contour;
};

LineWidths line_widths(const PlaneView& view) {
  const double scale = static_cast<double>(std::max(view.width, view.height)) / 1024.0;
  return {std::max(2.2 * scale, 1.5), std::max(1.1 * scale, 0.8)};
}

std::vector<Tick> numbers_in(const ColourRange& range) {
  return round_ticks(range.least(), range.most(), [](const Ticks& ticks) { return ticks.marks.size() <= kMostNumbers; })
      .marks;
}

// What a field looks like.
struct Appearance {
  std::function<Rgb(double)> colour;
  std::optional<Levels> contours;
  Legend legend;
};

// A bar with the levels that are within the range; none has contours, nor has the picture, where they would hide the
// colours.
Appearance with_contours(const std::string& title, const std::string& short_title, const ColourMap& colours,
                         const Levels& levels) {
  const ColourRange& range = colours.range();
  Appearance appearance{colours, levels, {title, LegendBar{colours, numbers_in(range), {}}, {}, short_title}};
  const double first = std::ceil((range.least() - levels.offset) / levels.step);
  const double last = std::floor((range.most() - levels.offset) / levels.step);
  if (last - first >= kMostContours) {
    appearance.contours.reset();
    return appearance;
  }
  for (double n = first; n <= last; n += 1.0) appearance.legend.bar->lines.push_back(levels.offset + n * levels.step);
  return appearance;
}

Appearance of_winding_numbers(std::span<const double> values) {
  return with_contours("winding number", "w", ColourMap(colour_range(values)), Levels{});
}

Appearance of_distances(std::span<const double> values) {
  const ColourMap colours(distance_colour_range(values));
  const std::vector<Tick> numbers = numbers_in(colours.range());
  const double step = numbers.size() < 2 ? colours.range().half_width : numbers[1].value - numbers[0].value;
  return with_contours("signed distance", "sdf", colours, {0.0, step});
}

Appearance of_inside() {
  const ColourMap colours({});
  return {colours, Levels{}, {"", {}, {{colours(1.0), "inside"}, {colours(0.0), "outside"}}}};
}

Rgb colour_of(std::int64_t label) {
  constexpr Rgb kNone{245, 245, 245};
  if (label == 0) return kNone;
  const auto [red, green, blue] = label_colour(static_cast<std::uint64_t>(label));
  return {red, green, blue};
}

double longer_side(const PlaneView& view) { return static_cast<double>(std::max(view.width, view.height)); }

std::string shortened(std::string text, const PlaneView& view) {
  const double room = kMostOfSide * longer_side(view), height = text_height(view);
  if (text_width(text, height) <= room) return text;
  while (!text.empty() && text_width(text + "..", height) > room) text.pop_back();
  return text + "..";
}

// As many as fit below each other into the picture.
std::size_t most_patches(const PlaneView& view, Legend legend) {
  while (legend.patches.size() < kMostPatches) {
    legend.patches.push_back({});
    if (static_cast<double>(legend_size(legend, text_height(view)).height) > longer_side(view)) {
      return legend.patches.size() - 1;
    }
  }
  return kMostPatches;
}

// The labels that the picture has, as many as there is room for.
Appearance of_labels(const PictureValues& values, const PlaneView& view) {
  Legend legend{"label", {}, {}, "label"};
  const std::size_t most = most_patches(view, legend);
  const std::set<double> present(values.values.begin(), values.values.end());
  for (const double value : present) {
    const auto label = static_cast<std::int64_t>(value);
    const bool full = legend.patches.size() + 1 == most && present.size() > most;
    if (full) {
      legend.patches.push_back({{}, "and " + std::to_string(present.size() - legend.patches.size()) + " more"});
      break;
    }
    const std::string name = label == 0 ? "none" : values.names[static_cast<std::size_t>(label - 1)];
    legend.patches.push_back({colour_of(label), shortened(std::to_string(label) + "  " + name, view)});
  }
  return {[](double value) { return colour_of(static_cast<std::int64_t>(value)); }, {}, std::move(legend)};
}

Appearance appearance_of(const PictureValues& values, const PlaneView& view) {
  switch (values.field) {
    case PictureField::kInside:
      return of_inside();
    case PictureField::kDistance:
      return of_distances(values.values);
    case PictureField::kLabel:
      return of_labels(values, view);
    case PictureField::kWinding:
      break;
  }
  return of_winding_numbers(values.values);
}

Image coloured(const PlaneView& view, std::span<const double> values, const std::function<Rgb(double)>& colour) {
  Image image(view.width, view.height);
  std::ranges::transform(values, image.pixels().begin(), colour);
  return image;
}

void draw_lines(Image& image, const PlaneView& view, std::span<const double> values, const TriangleMesh& mesh,
                const std::optional<Levels>& levels) {
  const std::vector<PictureSegment> curve = section_curve(mesh, view);
  const LineWidths widths = line_widths(view);
  if (levels) {
    Coverage contours(view.width, view.height);
    trace_contours(values, view.width, view.height, squares_on(curve, view.width, view.height), *levels,
                   [&](const PictureSegment& piece) { add_stroke(contours, piece, widths.contour); });
    blend(image, contours, kInk, 0.55);
  }
  Coverage section(view.width, view.height);
  for (const PictureSegment& segment : curve) add_stroke(section, segment, widths.section);
  blend(image, section, kInk);
}

}  // namespace

Image slice_picture(const PlaneView& view, const PictureValues& values, const TriangleMesh& mesh, PictureFrame frame) {
  const Appearance appearance = appearance_of(values, view);
  Image image = coloured(view, values.values, appearance.colour);
  draw_lines(image, view, values.values, mesh, appearance.contours);
  if (frame == PictureFrame::kNone || !has_frame(view)) return image;
  return framed_picture(image, view, appearance.legend, values.titles);
}

// One after the other: the values sorted for the range of colours; the image and coverages; the image and its page.
double slice_picture_bytes(const PlaneView& view, PictureFrame frame) {
  constexpr double kSorted = sizeof(double), kImage = sizeof(Rgb), kCoverages = 3;  // per pixel
  const double pixels = static_cast<double>(view.width) * static_cast<double>(view.height);
  const double page = frame != PictureFrame::kNone && has_frame(view) ? framed_picture_bytes(view) : 0.0;
  return std::max(pixels * kSorted, pixels * kImage + std::max(pixels * kCoverages, page));
}

}  // namespace raycone
