#include "app/picture/slice_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/picture/colour_map.h"
#include "app/picture/contours.h"
#include "app/picture/framed_picture.h"
#include "app/picture/legend.h"
#include "app/picture/section_curve.h"
#include "app/picture/ticks.h"

namespace raycone {
namespace {

constexpr std::size_t kMostLabels = 7;
constexpr double kMostContours = 14;  // in a legend

// In pixels, of pictures of different sizes alike up to a lower limit.
struct LineWidths {
  double section;
  double contour;
};

LineWidths line_widths(const PlaneView& view) {
  const double scale = static_cast<double>(std::max(view.width, view.height)) / 1024.0;
  return {std::max(2.2 * scale, 1.5), std::max(1.1 * scale, 0.8)};
}

ColourRange range_of(std::span<const double> values, PictureField field) {
  if (field == PictureField::kInside) return {};
  return field == PictureField::kDistance ? distance_colour_range(values) : colour_range(values);
}

std::vector<Tick> numbers_in(const ColourRange& range) {
  return round_ticks(range.least(), range.most(), [](const Ticks& ticks) { return ticks.marks.size() <= kMostLabels; })
      .marks;
}

Levels levels_of(const ColourRange& range, PictureField field) {
  if (field != PictureField::kDistance) return {};
  const std::vector<Tick> numbers = numbers_in(range);
  return {0.0, numbers.size() < 2 ? range.half_width : numbers[1].value - numbers[0].value};
}

Legend legend_of(const ColourRange& range, const Levels& levels, PictureField field) {
  if (field == PictureField::kInside) return {"", {{1.0, "inside"}, {0.0, "outside"}}, {}, false};
  Legend legend{field == PictureField::kDistance ? "sdf" : "w", numbers_in(range), {}, true};
  const double first = std::ceil((range.least() - levels.offset) / levels.step);
  const double last = std::floor((range.most() - levels.offset) / levels.step);
  if (last - first >= kMostContours) return legend;
  for (double n = first; n <= last; n += 1.0) legend.lines.push_back(levels.offset + n * levels.step);
  return legend;
}

Image coloured(const PlaneView& view, std::span<const double> values, const ColourMap& colours) {
  Image image(view.width, view.height);
  std::ranges::transform(values, image.pixels().begin(), [&](double w) { return colours(w); });
  return image;
}

void draw_lines(Image& image, const PlaneView& view, std::span<const double> values, const TriangleMesh& mesh,
                const Levels& levels) {
  const std::vector<PictureSegment> curve = section_curve(mesh, view);
  const LineWidths widths = line_widths(view);
  Coverage contours(view.width, view.height);
  trace_contours(values, view.width, view.height, squares_on(curve, view.width, view.height), levels,
                 [&](const PictureSegment& piece, double) { add_stroke(contours, piece, widths.contour); });
  blend(image, contours, kInk, 0.55);
  Coverage section(view.width, view.height);
  for (const PictureSegment& segment : curve) add_stroke(section, segment, widths.section);
  blend(image, section, kInk);
}

}  // namespace

Image slice_picture(const PlaneView& view, std::span<const double> values, const TriangleMesh& mesh, PictureField field,
                    bool framed) {
  const ColourMap colours(range_of(values, field));
  const Levels levels = levels_of(colours.range(), field);
  Image image = coloured(view, values, colours);
  draw_lines(image, view, values, mesh, levels);
  if (!framed || !has_frame(view)) return image;
  return framed_picture(image, view, legend_of(colours.range(), levels, field), colours);
}

double slice_picture_bytes(const PlaneView& view, bool framed) {
  constexpr double kPerPixel = sizeof(double) + sizeof(Rgb) + 3;  // sorted values, image, coverages
  const double plot = kPerPixel * static_cast<double>(view.width) * static_cast<double>(view.height);
  return plot + (framed && has_frame(view) ? framed_picture_bytes(view) : 0.0);
}

}  // namespace raycone
