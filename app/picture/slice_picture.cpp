#include "app/picture/slice_picture.h"

#include <algorithm>

#include "app/picture/colour_map.h"
#include "app/picture/contours.h"
#include "app/picture/legend.h"
#include "app/picture/section_curve.h"

namespace raycone {
namespace {

// In pixels, of pictures of different sizes alike up to a lower limit.
struct LineWidths {
  double section;
  double contour;
};

LineWidths line_widths(const PlaneView& view) {
  const double scale = static_cast<double>(std::max(view.width, view.height)) / 1024.0;
  return {std::max(2.2 * scale, 1.5), std::max(1.1 * scale, 0.8)};
}

Image coloured(const PlaneView& view, std::span<const double> values, const ColourMap& colours) {
  Image image(view.width, view.height);
  std::ranges::transform(values, image.pixels().begin(), [&](double w) { return colours(w); });
  return image;
}

}  // namespace

Image slice_picture(const PlaneView& view, std::span<const double> values, const TriangleMesh& mesh, bool legend) {
  const ColourMap colours(colour_range(values));
  Image image = coloured(view, values, colours);
  const std::vector<PictureSegment> curve = section_curve(mesh, view);
  const LineWidths widths = line_widths(view);

  Coverage contours(view.width, view.height);
  trace_contours(values, view.width, view.height, squares_on(curve, view.width, view.height),
                 [&](const PictureSegment& piece, double) { add_stroke(contours, piece, widths.contour); });
  blend(image, contours, kInk, 0.55);

  Coverage& drawn = contours;  // the legend asks where either is
  Coverage section(view.width, view.height);
  for (const PictureSegment& segment : curve) add_stroke(section, segment, widths.section);
  blend(image, section, kInk);
  std::ranges::transform(drawn.pixels(), section.pixels(), drawn.pixels().begin(),
                         [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
  if (legend) add_legend(image, drawn, colours);
  return image;
}

}  // namespace raycone
