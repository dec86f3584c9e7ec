#include "app/picture/framed_picture.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "app/picture/text.h"
#include "app/picture/ticks.h"

namespace raycone {
namespace {

constexpr Rgb kPage{255, 255, 255};

// In units of the height of digits.
constexpr double kTop = 2.4;  // as far as the legend's bar is below its title
constexpr double kBottom = 4.8;
constexpr double kTickLength = 0.45;
constexpr double kTickGap = 0.4;  // between a tick and its number
constexpr double kNameGap = 0.8;  // between the name of the axis upwards and its numbers
constexpr double kEdge = 0.7;     // between all that is drawn and the page's border
constexpr double kLegendGap = 1.4;
constexpr double kTitleLine = 1.2;  // from the page's top to what titles stand on

// What a side of the plot shows.
struct PlotAxis {
  std::string name;
  double begin;  // at the left or lower border
  double end;

  // From 0 at the beginning to 1.
  [[nodiscard]] double position_of(double value) const { return (value - begin) / (end - begin); }
};

PlotAxis plot_axis(const Vec3& direction, const char* other_name, const PlaneView& view, std::int64_t pixels) {
  const double length = static_cast<double>(pixels) * view.pixel;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) != 1.0) continue;
    const double begin = view.corner[axis];
    return {std::string(1, "xyz"[axis]), begin, begin + direction[axis] * length};
  }
  const double begin = dot(view.corner - view.origin, direction);
  return {other_name, begin, begin + length};
}

// Pixels from the page's top left corner.
struct PageLayout {
  double text = 0.0;
  std::int64_t left = 0, top = 0;      // of the plot
  std::int64_t width = 0, height = 0;  // of the plot
  std::int64_t page_width = 0, page_height = 0;
  Ticks across, upwards;

  [[nodiscard]] std::int64_t right() const { return left + width; }
  [[nodiscard]] std::int64_t legend_left() const { return right() + std::llround(kLegendGap * text); }
  [[nodiscard]] std::int64_t bottom() const { return top + height; }
};

double widest(const Ticks& ticks, double text) {
  double width = 0.0;
  for (const Tick& tick : ticks.marks) width = std::max(width, text_width(tick.text, text));
  return width;
}

// Pixels between neighbouring ticks along a side of `length` pixels.
double pitch(const Ticks& ticks, const PlotAxis& axis, double length) {
  if (ticks.marks.size() < 2) return length;
  return std::abs(axis.position_of(ticks.marks[1].value) - axis.position_of(ticks.marks[0].value)) * length;
}

void choose_ticks(PageLayout& layout, const PlotAxis& across, const PlotAxis& upwards) {
  const double t = layout.text;
  layout.across = round_ticks(across.begin, across.end, [&](const Ticks& ticks) {
    const double room = pitch(ticks, across, static_cast<double>(layout.width));
    return room >= std::max(widest(ticks, t) + 2.0 * t, 6.0 * t);
  });
  layout.upwards = round_ticks(upwards.begin, upwards.end, [&](const Ticks& ticks) {
    return pitch(ticks, upwards, static_cast<double>(layout.height)) >= 4.0 * t;
  });
}

// Room for the name of the axis upwards beside its numbers. With an offset it is long, and stands above them.
double room_for_name(const PlotAxis& upwards, const Ticks& ticks, double text) {
  return ticks.offset.empty() ? text_width(upwards.name, text) + kNameGap * text : 0.0;
}

// The plot gets what its ticks and the legend leave of the page; the ticks depend on the plot's size.
PageLayout lay_out(const PlaneView& view, const PlotAxis& across, const PlotAxis& upwards, const Legend& legend) {
  PageLayout layout;
  const double t = layout.text = text_height(view);
  const std::int64_t longer = std::max(view.width, view.height);
  const LegendSize key = legend_size(legend, t);
  layout.top = std::llround(kTop * t);
  layout.width = view.width;
  layout.height = view.height;
  for (int pass = 0; pass < 3; ++pass) {
    choose_ticks(layout, across, upwards);
    const double numbers = std::max(widest(layout.upwards, t), widest(layout.across, t) / 2 - kTickLength * t);
    const double name = room_for_name(upwards, layout.upwards, t);
    layout.left = std::llround((kEdge + kTickGap + kTickLength) * t + name + numbers);
    const std::int64_t beside = layout.left + std::llround((kLegendGap + kEdge) * t) + key.width;
    const std::int64_t above = layout.top + std::llround(kBottom * t);
    const double scale =
        std::min(static_cast<double>(std::max(longer - beside, std::int64_t{1})) / static_cast<double>(view.width),
                 static_cast<double>(std::max(longer - above, std::int64_t{1})) / static_cast<double>(view.height));
    const auto shrunk_side = [&](std::int64_t pixels) {
      return std::max(std::llround(scale * static_cast<double>(pixels)), 1LL);
    };
    layout.width = shrunk_side(view.width);
    layout.height = shrunk_side(view.height);
    layout.page_width = std::min(layout.width + beside, longer);
    const std::int64_t least = key.height + std::llround(kEdge * t);  // the legend begins at the page's top
    layout.page_height = std::min(std::max(layout.height + above, least), longer);
  }
  return layout;
}

// The middle of the stroke of a tick: pixels, not borders between them, so that it is sharp.
double pixel_at(std::int64_t begin, std::int64_t length, double position) {
  const double at = std::floor(position * static_cast<double>(length));
  return static_cast<double>(begin) + std::clamp(at, 0.0, static_cast<double>(length - 1)) + 0.5;
}

void draw_axis_across(Coverage& ink, const PageLayout& layout, const PlotAxis& axis, double stroke) {
  const double t = layout.text;
  const auto bottom = static_cast<double>(layout.bottom());
  const double baseline = bottom + (kTickLength + kTickGap + 1.0) * t;
  for (const Tick& tick : layout.across.marks) {
    const double x = pixel_at(layout.left, layout.width, axis.position_of(tick.value));
    add_stroke(ink, {{x, bottom + stroke}, {x, bottom + kTickLength * t}}, stroke);  // round ends stay off the plot
    add_text(ink, tick.text, x - text_width(tick.text, t) / 2, baseline, t);
  }
  const std::string label = axis.name + layout.across.offset;
  const double middle = static_cast<double>(layout.left + layout.right()) / 2;
  const double most = static_cast<double>(layout.page_width) - text_width(label, t) - kEdge * t;
  const double left = std::min(middle - text_width(label, t) / 2, most);
  add_text(ink, label, std::max(left, kEdge * t), baseline + 1.7 * t, t);
}

// Returns where the label above it ends, if there is one.
double draw_axis_upwards(Coverage& ink, const PageLayout& layout, const PlotAxis& axis, double stroke) {
  const double t = layout.text;
  const auto left = static_cast<double>(layout.left);
  const double number_right = left - (kTickLength + kTickGap) * t;
  for (const Tick& tick : layout.upwards.marks) {
    const double y = pixel_at(layout.top, layout.height, 1.0 - axis.position_of(tick.value));
    add_stroke(ink, {{left - kTickLength * t, y}, {left - stroke, y}}, stroke);
    add_text(ink, tick.text, number_right - text_width(tick.text, t), y + t / 2, t);
  }
  if (layout.upwards.offset.empty()) {
    add_text(ink, axis.name, kEdge * t, (static_cast<double>(layout.top + layout.bottom()) + t) / 2, t);
    return 0.0;
  }
  const std::string label = axis.name + layout.upwards.offset;
  add_text(ink, label, kEdge * t, kTitleLine * t, t);
  return kEdge * t + text_width(label, t);
}

// Right of `end`. The legend's title begins above it, or further left where the page would end before it does.
void draw_titles(Coverage& ink, const PageLayout& layout, const Legend& legend, std::span<const std::string> titles,
                 double end) {
  const double t = layout.text;
  const double begin = std::max(static_cast<double>(layout.left), end + 2.5 * t);
  const auto above_legend = static_cast<double>(layout.legend_left()) + std::max(t / 12.0, 1.0);
  const double most = static_cast<double>(layout.page_width) - kEdge * t - text_width(legend.title, t);
  const bool fits = std::min(most, above_legend) >= begin;
  const double legend_left = fits ? std::min(most, above_legend) : above_legend;
  add_text(ink, fits ? legend.title : legend.short_title, legend_left, kTitleLine * t, t);
  for (const std::string& title : titles) {
    if (begin + text_width(title, t) + t > legend_left) continue;
    add_text(ink, title, begin, kTitleLine * t, t);
    return;
  }
}

void draw_frame(Coverage& ink, const PageLayout& layout, double stroke) {
  const double left = static_cast<double>(layout.left) - stroke / 2;
  const double right = static_cast<double>(layout.right()) + stroke / 2;
  const double top = static_cast<double>(layout.top) - stroke / 2;
  const double bottom = static_cast<double>(layout.bottom()) + stroke / 2;
  add_stroke(ink, {{left, top}, {right, top}}, stroke);
  add_stroke(ink, {{left, bottom}, {right, bottom}}, stroke);
  add_stroke(ink, {{left, top}, {left, bottom}}, stroke);
  add_stroke(ink, {{right, top}, {right, bottom}}, stroke);
}

}  // namespace

double text_height(const PlaneView& view) {
  return std::clamp(static_cast<double>(std::max(view.width, view.height)) / 80.0, 7.0, 48.0);
}

bool has_frame(const PlaneView& view) { return std::max(view.width, view.height) >= kLeastFramedSize; }

Image framed_picture(const Image& plot, const PlaneView& view, const Legend& legend,
                     std::span<const std::string> titles) {
  const PlotAxis across = plot_axis(view.right, "u", view, view.width);
  const PlotAxis upwards = plot_axis(view.up, "v", view, view.height);
  const PageLayout layout = lay_out(view, across, upwards, legend);
  Image page(layout.page_width, layout.page_height, kPage);
  paste(page, shrunk(plot, layout.width, layout.height), {layout.left, layout.top});
  Coverage ink(layout.page_width, layout.page_height);
  const double stroke = std::max(std::round(layout.text / 12.0), 1.0);
  draw_frame(ink, layout, stroke);
  draw_axis_across(ink, layout, across, stroke);
  draw_titles(ink, layout, legend, titles, draw_axis_upwards(ink, layout, upwards, stroke));
  blend(page, ink, kInk);
  draw_legend(page, legend, layout.text, {layout.legend_left(), 0});
  return page;
}

double framed_picture_bytes(const PlaneView& view) {
  const auto shorter = static_cast<double>(std::min(view.width, view.height));
  const auto longer = static_cast<double>(std::max(view.width, view.height));
  constexpr double kMostMargins = 30.0;  // of axes and legend, in heights of digits
  const double page = longer * std::min(longer, shorter + kMostMargins * text_height(view));
  constexpr double kRowSums = 3 * sizeof(double) + 2 * 24;  // while shrinking
  return page * (2 * sizeof(Rgb) + 1) + longer * 2 * kRowSums;
}

}  // namespace raycone
