#include "app/picture/legend.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "app/picture/text.h"

namespace raycone {
namespace {

constexpr Rgb kPaper{255, 255, 255};
constexpr double kPaperOpacity = 0.88;

constexpr std::size_t kMostLabels = 7;
constexpr std::size_t kMostContours = 14;

// Of the picture's sides, as far as the panel may reach.
constexpr double kLargestPart = 0.6;

struct Label {
  double value;
  std::string text;
};

std::string printed(double value) {
  std::array<char, 64> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed);
  return {text.data(), end};
}

// The multiples of `step` in the range, or nothing if they are too many.
std::vector<double> multiples_in(const ColourRange& range, double step, double offset, std::size_t most) {
  std::vector<double> result;
  for (double n = std::ceil((range.least() - offset) / step); n * step + offset <= range.most(); n += 1.0) {
    if (result.size() == most) return {};
    result.push_back(n * step + offset);
  }
  return result;
}

std::vector<Label> labels_of(const ColourRange& range) {
  std::vector<double> values;
  for (double decade = 0.1; values.empty(); decade *= 10.0) {
    for (const double digit : {5.0, 10.0, 20.0}) {
      if (values.empty()) values = multiples_in(range, digit * decade, 0.0, kMostLabels);
    }
  }
  std::vector<Label> labels;
  for (const double value : values) labels.push_back({value, printed(value)});
  return labels;
}

// All in pixels, from the panel's top left corner.
struct Layout {
  double text;  // height of digits
  double margin;
  double bar_left, bar_width;
  double bar_top, bar_height;
  double label_left;
  std::int64_t width, height;

  [[nodiscard]] double row_of(double value, const ColourRange& range) const {
    return bar_top + bar_height * (range.most() - value) / (range.most() - range.least());
  }
};

Layout layout_for(const Image& image, const std::vector<Label>& labels) {
  Layout layout{};
  layout.text = std::max(static_cast<double>(std::max(image.width(), image.height())) / 80.0, 7.0);
  const double t = layout.text;
  layout.margin = t;
  layout.bar_left = t;
  layout.bar_width = std::round(1.3 * t);
  layout.bar_top = std::round(3.0 * t);
  layout.bar_height = std::round(12.0 * t);
  layout.label_left = layout.bar_left + layout.bar_width + 0.9 * t;
  double widest = 0.0;
  for (const Label& label : labels) widest = std::max(widest, text_width(label.text, t));
  layout.width = std::llround(layout.label_left + widest + t);
  layout.height = std::llround(layout.bar_top + layout.bar_height + 1.4 * t);
  return layout;
}

std::uint64_t hidden(const Coverage& drawn, const Layout& layout, PixelOffset offset) {
  std::uint64_t sum = 0;
  for (std::int64_t row = 0; row < layout.height; ++row) {
    for (std::int64_t column = 0; column < layout.width; ++column) {
      sum += drawn.at(offset.column + column, offset.row + row);
    }
  }
  return sum;
}

PixelOffset best_corner(const Coverage& drawn, const Layout& layout) {
  const auto gap = static_cast<std::int64_t>(layout.margin);
  const std::int64_t right = drawn.width() - layout.width - gap;
  const std::int64_t bottom = drawn.height() - layout.height - gap;
  const std::array<PixelOffset, 4> corners{{{right, gap}, {right, bottom}, {gap, gap}, {gap, bottom}}};
  return *std::ranges::min_element(corners, {}, [&](PixelOffset at) { return hidden(drawn, layout, at); });
}

// Half the bar's width at a row; beyond an end that values exceed, the bar comes to a point.
double half_width_at(double row, const Layout& layout, const ColourRange& range) {
  const double above = layout.bar_top - row;
  const double below = row - layout.bar_top - layout.bar_height;
  if (above <= 0.0 && below <= 0.0) return layout.bar_width / 2;
  if (!(above > 0.0 ? range.exceeded_above : range.exceeded_below)) return 0.0;
  return std::max(layout.bar_width / 2 - std::max(above, below), 0.0);
}

void draw_bar(Image& image, const Layout& layout, const ColourMap& colours, PixelOffset offset) {
  const ColourRange& range = colours.range();
  const double middle = layout.bar_left + layout.bar_width / 2;
  for (std::int64_t row = 0; row < layout.height; ++row) {
    const double y = static_cast<double>(row) + 0.5;
    const double half_width = half_width_at(y, layout, range);
    const double value = range.most() - (y - layout.bar_top) / layout.bar_height * (range.most() - range.least());
    for (std::int64_t column = 0; column < layout.width; ++column) {
      if (std::abs(static_cast<double>(column) + 0.5 - middle) >= half_width) continue;
      image.at(offset.column + column, offset.row + row) = colours(value);
    }
  }
}

void draw_numbers(Coverage& ink, const Layout& layout, const ColourRange& range, const std::vector<Label>& labels) {
  const double stroke = std::max(layout.text / 12.0, 1.0);
  const double right = layout.bar_left + layout.bar_width;
  for (const Label& label : labels) {
    const double row = layout.row_of(label.value, range);
    add_stroke(ink, {{right, row}, {right + 0.45 * layout.text, row}}, stroke);
    add_text(ink, label.text, layout.label_left, row + layout.text / 2, layout.text);
  }
  add_text(ink, "w", layout.bar_left + layout.bar_width / 2 - text_width("w", layout.text) / 2, 1.8 * layout.text,
           layout.text);
}

void draw_contours(Coverage& ink, const Layout& layout, const ColourRange& range) {
  const double stroke = std::max(layout.text / 12.0, 1.0);
  for (const double level : multiples_in(range, 1.0, 0.5, kMostContours)) {
    const double row = layout.row_of(level, range);
    add_stroke(ink, {{layout.bar_left, row}, {layout.bar_left + layout.bar_width, row}}, stroke);
  }
}

}  // namespace

void add_legend(Image& image, const Coverage& drawn, const ColourMap& colours) {
  const ColourRange& range = colours.range();
  const std::vector<Label> labels = labels_of(range);
  const Layout layout = layout_for(image, labels);
  if (static_cast<double>(layout.width) > kLargestPart * static_cast<double>(image.width())) return;
  if (static_cast<double>(layout.height) > kLargestPart * static_cast<double>(image.height())) return;
  const PixelOffset offset = best_corner(drawn, layout);

  Coverage paper(layout.width, layout.height);
  add_round_rectangle(paper, {{0, 0}, {static_cast<double>(layout.width), static_cast<double>(layout.height)}},
                      layout.text / 2);
  blend(image, paper, kPaper, kPaperOpacity, offset);
  draw_bar(image, layout, colours, offset);
  Coverage contours(layout.width, layout.height);
  draw_contours(contours, layout, range);
  blend(image, contours, kInk, 0.55, offset);
  Coverage ink(layout.width, layout.height);
  draw_numbers(ink, layout, range, labels);
  blend(image, ink, kInk, 1.0, offset);
}

}  // namespace raycone
