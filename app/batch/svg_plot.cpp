#include "app/batch/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>

#include "app/text/html.h"
#include "app/text/readable_count.h"

namespace raycone {
namespace {

// Sizes in the units of the drawing.
constexpr double kWidth = 420.0;
constexpr double kHeight = 300.0;
constexpr double kLeft = 64.0;
constexpr double kRight = 24.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 46.0;

// Of a decade, in histograms.
constexpr int kBinsPerDecade = 4;

template <typename... Numbers>
std::string formatted(const char* format, Numbers... numbers) {
  char text[256];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// A logarithmic axis over whole decades. Zeros lie half a decade below the first one.
class LogScale {
 public:
  LogScale(const std::vector<double>& values, double from, double to) : from_(from), to_(to) {
    double least = INFINITY;
    double most = 0.0;
    for (const double value : values) {
      if (value > 0.0) least = std::min(least, value);
      most = std::max(most, value);
      zeros_ = zeros_ || value <= 0.0;
    }
    if (most <= 0.0) least = most = 1.0;
    first_ = static_cast<int>(std::floor(std::log10(least)));
    last_ = std::max(static_cast<int>(std::ceil(std::log10(most))), first_ + 1);
  }

  [[nodiscard]] double position(double value) const {
    const double start = first_ - (zeros_ ? 1.0 : 0.0);
    const double decade = value > 0.0 ? std::log10(value) : first_ - 0.5;
    return from_ + (to_ - from_) * (decade - start) / (last_ - start);
  }

  // Powers of ten, and 0 where there is one.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> values;
    if (zeros_) values.push_back(0.0);
    const int step = (last_ - first_ + 7) / 8;  // more labels would overlap
    for (int decade = first_; decade <= last_; decade += step) values.push_back(std::pow(10.0, decade));
    return values;
  }

 private:
  double from_;
  double to_;
  int first_ = 0;
  int last_ = 1;
  bool zeros_ = false;
};

std::string text_at(double x, double y, const char* attributes, const std::string& text) {
  return formatted("<text x=\"%.1f\" y=\"%.1f\" ", x, y) + attributes + ">" + html_text(text) + "</text>\n";
}

std::string line_between(double x0, double y0, double x1, double y1) {
  return formatted("<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", x0, y0, x1, y1);
}

std::string x_axis(const LogScale& scale, const PlotAxis& axis) {
  std::string svg;
  for (const double tick : scale.ticks()) {
    const double x = scale.position(tick);
    svg += line_between(x, kTop, x, kHeight - kBottom);
    svg += text_at(x, kHeight - kBottom + 15.0, "text-anchor=\"middle\"", readable_quantity(tick, axis.quantity));
  }
  const double middle = (kLeft + kWidth - kRight) / 2.0;
  return svg + text_at(middle, kHeight - 8.0, "class=\"label\" text-anchor=\"middle\"", axis.label);
}

std::string y_label(const std::string& label) {
  const double middle = (kTop + kHeight - kBottom) / 2.0;
  return text_at(-middle, 13.0, "class=\"label\" text-anchor=\"middle\" transform=\"rotate(-90)\"", label);
}

std::string y_axis(const LogScale& scale, const PlotAxis& axis) {
  std::string svg;
  for (const double tick : scale.ticks()) {
    const double y = scale.position(tick);
    svg += line_between(kLeft, y, kWidth - kRight, y);
    svg += text_at(kLeft - 6.0, y + 4.0, "text-anchor=\"end\"", readable_quantity(tick, axis.quantity));
  }
  return svg + y_label(axis.label);
}

// A linear axis of counts, from 0.
std::string count_axis(std::size_t most) {
  std::string svg;
  const std::size_t step = std::max<std::size_t>((most + 3) / 4, 1);
  for (std::size_t count = 0; count <= most; count += step) {
    const double y =
        kHeight - kBottom - (kHeight - kBottom - kTop) * static_cast<double>(count) / static_cast<double>(most);
    svg += line_between(kLeft, y, kWidth - kRight, y);
    svg += text_at(kLeft - 6.0, y + 4.0, "text-anchor=\"end\"", std::to_string(count));
  }
  return svg + y_label("meshes");
}

std::string figure(const std::string& title, const std::string& body) {
  return formatted("<svg viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"", kWidth, kHeight) + html_text(title) +
         "\">\n" + body + "</svg>\n";
}

// Rounded down to a multiple of a quarter of a decade; zeros have a bin below all others.
int bin_of(double value) {
  constexpr int kZeroBin = -10000;
  return value > 0.0 ? static_cast<int>(std::floor(std::log10(value) * kBinsPerDecade + 1e-9)) : kZeroBin;
}

double start_of(int bin) { return std::pow(10.0, static_cast<double>(bin) / kBinsPerDecade); }

}  // namespace

std::string readable_quantity(double value, Quantity quantity) {
  if (value == 0.0) return "0";
  if (quantity == Quantity::kCount) return readable_count(value);
  struct Unit {
    double size;
    const char* name;
  };
  static constexpr Unit kTimes[] = {{1.0, " s"}, {1e-3, " ms"}, {1e-6, " \xC2\xB5s"}, {1e-9, " ns"}};
  const Unit* unit = kTimes;
  for (int i = 0; i < 3 && value < unit->size * (1.0 - 1e-9); ++i) ++unit;
  const double number = value / unit->size;
  return formatted(number < 999.5 ? "%.3g" : "%.0f", number) + unit->name;
}

std::string scatter_plot(const PlotAxis& x, const PlotAxis& y, const std::vector<PlotPoint>& points) {
  std::vector<double> xs;
  std::vector<double> ys;
  for (const PlotPoint& point : points) {
    xs.push_back(point.x);
    ys.push_back(point.y);
  }
  const LogScale x_scale(xs, kLeft, kWidth - kRight);
  const LogScale y_scale(ys, kHeight - kBottom, kTop);
  std::string body = x_axis(x_scale, x) + y_axis(y_scale, y);
  for (const PlotPoint& point : points) {
    body += formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"><title>", x_scale.position(point.x),
                      y_scale.position(point.y)) +
            html_text(point.name + ": " + readable_quantity(point.x, x.quantity) + ", " +
                      readable_quantity(point.y, y.quantity)) +
            "</title></circle>\n";
  }
  return figure(y.label + " against " + x.label, body);
}

std::string histogram(const PlotAxis& axis, const std::vector<double>& values) {
  const LogScale scale(values, kLeft, kWidth - kRight);
  std::map<int, std::size_t> counts;
  std::size_t most = 1;
  for (const double value : values) most = std::max(most, ++counts[bin_of(value)]);
  std::string body = x_axis(scale, axis) + count_axis(most);
  for (const auto& [bin, count] : counts) {
    const bool zero = bin == bin_of(0.0);
    const double middle = scale.position(0.0);
    const double quarter = (scale.position(start_of(1)) - scale.position(start_of(0))) / 2.0;
    const double left = zero ? middle - quarter : scale.position(start_of(bin));
    const double right = zero ? middle + quarter : scale.position(start_of(bin + 1));
    const double height = (kHeight - kBottom - kTop) * static_cast<double>(count) / static_cast<double>(most);
    body +=
        formatted("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"><title>", left + 0.5,
                  kHeight - kBottom - height, std::max(right - left - 1.0, 1.0), height) +
        html_text(std::to_string(count) + (zero ? " at 0"
                                                : " from " + readable_quantity(start_of(bin), axis.quantity) + " to " +
                                                      readable_quantity(start_of(bin + 1), axis.quantity))) +
        "</title></rect>\n";
  }
  return figure(axis.label, body);
}

}  // namespace raycone
