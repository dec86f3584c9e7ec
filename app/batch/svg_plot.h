// Plots as inline SVG, with logarithmic axes.
#pragma once

#include <string>
#include <vector>

namespace raycone {

enum class Quantity { kCount, kSeconds };

struct PlotAxis {
  std::string label;
  Quantity quantity = Quantity::kCount;
};

struct PlotPoint {
  double x = 0.0;  // zeros and below have a place of their own at the start of the axis
  double y = 0.0;
  std::string name;
};

// Points, each showing its name and values under the pointer.
[[nodiscard]] std::string scatter_plot(const PlotAxis& x, const PlotAxis& y, const std::vector<PlotPoint>& points);

// How many of `values` lie in each quarter of a decade.
[[nodiscard]] std::string histogram(const PlotAxis& axis, const std::vector<double>& values);

// "120 k", "3.5 ms"
[[nodiscard]] std::string readable_quantity(double value, Quantity quantity);

}  // namespace raycone
