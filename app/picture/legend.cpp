#include "app/picture/legend.h"

#include <algorithm>
#include <cmath>

#include "app/picture/text.h"

namespace raycone {
namespace {

// In units of the height of digits.
constexpr double kBarWidth = 1.3;
constexpr double kBarTop = 2.4;
constexpr double kBarHeight = 12.0;
constexpr double kLabelLeft = kBarWidth + 0.9;
constexpr double kPatchPitch = 2.1;

// All in pixels, from the legend's top left corner.
struct BarLayout {
  double text;
  double width, top, height;  // of the bar, which is at the left

  explicit BarLayout(double text_height)
      : text(text_height),
        width(std::round(kBarWidth * text)),
        top(std::round(kBarTop * text)),
        height(std::round(kBarHeight * text)) {}

  [[nodiscard]] double row_of(double value, const ColourRange& range) const {
    return top + height * (0.5 - 0.5 * ((value - range.centre) / range.half_width));
  }
};

// Half the bar's width at a row; beyond an end that values exceed, the bar comes to a point.
double half_width_at(double row, const BarLayout& layout, const ColourRange& range) {
  const double above = layout.top - row;
  const double below = row - layout.top - layout.height;
  if (above <= 0.0 && below <= 0.0) return layout.width / 2;
  if (!(above > 0.0 ? range.exceeded_above : range.exceeded_below)) return 0.0;
  return std::max(layout.width / 2 - std::max(above, below), 0.0);
}

void draw_colours(Image& image, const BarLayout& layout, const ColourMap& colours, LegendSize size,
                  PixelOffset corner) {
  const ColourRange& range = colours.range();
  for (std::int64_t row = 0; row < size.height; ++row) {
    const double y = static_cast<double>(row) + 0.5;
    const double half_width = half_width_at(y, layout, range);
    const double value = range.centre + (1.0 - 2.0 * (y - layout.top) / layout.height) * range.half_width;
    for (std::int64_t column = 0; column < size.width; ++column) {
      if (std::abs(static_cast<double>(column) + 0.5 - layout.width / 2) >= half_width) continue;
      image.at(corner.column + column, corner.row + row) = colours(value);
    }
  }
}

void draw_bar_numbers(Coverage& ink, const BarLayout& layout, const LegendBar& bar) {
  const double stroke = std::max(layout.text / 12.0, 1.0);
  for (const Tick& number : bar.numbers) {
    const double row = layout.row_of(number.value, bar.colours.range());
    add_stroke(ink, {{layout.width, row}, {layout.width + 0.45 * layout.text, row}}, stroke);
    add_text(ink, number.text, kLabelLeft * layout.text, row + layout.text / 2, layout.text);
  }
}

void draw_bar_lines(Coverage& ink, const BarLayout& layout, const LegendBar& bar) {
  const double stroke = std::max(layout.text / 12.0, 1.0);
  for (const double level : bar.lines) {
    const double row = layout.row_of(level, bar.colours.range());
    add_stroke(ink, {{0.0, row}, {layout.width, row}}, stroke);
  }
}

void draw_bar(Image& image, const LegendBar& bar, double text, LegendSize size, PixelOffset corner) {
  const BarLayout layout(text);
  draw_colours(image, layout, bar.colours, size, corner);
  Coverage lines(size.width, size.height);
  draw_bar_lines(lines, layout, bar);
  blend(image, lines, kInk, 0.55, corner);
  Coverage numbers(size.width, size.height);
  draw_bar_numbers(numbers, layout, bar);
  blend(image, numbers, kInk, 1.0, corner);
}

void draw_patches(Image& image, const std::vector<LegendPatch>& patches, double text, LegendSize size,
                  PixelOffset corner) {
  Coverage words(size.width, size.height);
  const auto side = static_cast<std::int64_t>(std::round(kBarWidth * text));
  double top = std::round(kBarTop * text);
  for (const LegendPatch& patch : patches) {
    const auto first = static_cast<std::int64_t>(top);
    for (std::int64_t row = first; patch.colour && row < first + side; ++row) {
      for (std::int64_t column = 0; column < side; ++column) {
        image.at(corner.column + column, corner.row + row) = *patch.colour;
      }
    }
    add_text(words, patch.text, kLabelLeft * text, top + (static_cast<double>(side) + text) / 2, text);
    top += std::round(kPatchPitch * text);
  }
  blend(image, words, kInk, 1.0, corner);
}

}  // namespace

LegendSize legend_size(const Legend& legend, double text) {
  double widest = 0.0;
  for (const LegendPatch& patch : legend.patches) widest = std::max(widest, text_width(patch.text, text));
  if (legend.bar) {
    for (const Tick& number : legend.bar->numbers) widest = std::max(widest, text_width(number.text, text));
  }
  const double width = std::max(kLabelLeft * text + widest, text_width(legend.short_title, text)) + 0.3 * text;
  const double below = legend.bar ? kBarHeight + 1.0 : kPatchPitch * static_cast<double>(legend.patches.size());
  const double height = std::round(kBarTop * text) + below * text + 1.0;
  return {std::llround(std::ceil(width)), std::llround(std::ceil(height))};
}

void draw_legend(Image& image, const Legend& legend, double text, PixelOffset corner) {
  const LegendSize size = legend_size(legend, text);
  if (legend.bar) draw_bar(image, *legend.bar, text, size, corner);
  draw_patches(image, legend.patches, text, size, corner);
}

}  // namespace raycone
