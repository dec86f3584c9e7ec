// Which rows of a lattice a triangle concerns.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/crossings/row.h"
#include "core/data/interval.h"
#include "core/data/vec3.h"

namespace raycone {

// The sections of a triangle's projection with lines along one axis. Of all rows in the projection's box, a triangle
// that is long and thin concerns few.
class TriangleSections {
 public:
  // Lines along one of the axes y and z (1 and 2), across the other one.
  TriangleSections(const Vec3& a, const Vec3& b, const Vec3& c, int along)
      : edges_{EdgeSection(a, b, along), EdgeSection(b, c, along), EdgeSection(c, a, along)} {}

  // Calls visit(i) once for each i of [begin, end) where the row at coordinates[i] of the line at `across` meets the
  // closed projection or the line of an edge: all other rows of the closed box, in which [begin, end) lies, neither
  // cross the triangle nor tie with it. And for few others. `per_unit` as in Row.
  template <class Visit>
  void visit(double across, std::span<const double> coordinates, double per_unit, std::uint32_t begin,
             std::uint32_t end, const Visit& visit) const;

 private:
  struct EdgeSection {
    double along, across, slope;  // a point on it
    Interval extent;              // across
    bool parallel, point;         // to the lines of the sections; projects to a point

    EdgeSection(const Vec3& a, const Vec3& b, int axis)
        : along(a[axis]),
          across(a[3 - axis]),
          slope(slope_of(b[axis] - along, b[3 - axis] - across)),
          extent{std::min(across, b[3 - axis]), std::max(across, b[3 - axis])},
          parallel(across == b[3 - axis]),
          point(parallel && along == b[axis]) {}

    // NaN where the width is beyond the doubles, as offsets are then where only the height is.
    static double slope_of(double height, double width) {
      return std::isfinite(width) ? height / width : std::numeric_limits<double>::quiet_NaN();
    }

    // Where its line is, widened by more than the error: differences, quotient and product are each rounded once (5 u
    // of the product), the sum once more; u = 2^-53. A quotient that underflows is off by 2^-1075, and multiplied.
    [[nodiscard]] Interval at(double line) const {
      constexpr double kError = 8 * 0x1p-53, kSlopeUnderflow = 0x1p-1073, kUnderflow = 0x1p-1000;
      const double reach = line - across, offset = reach * slope;
      const double error =
          kError * (std::abs(along) + std::abs(offset)) + kSlopeUnderflow * std::abs(reach) + kUnderflow;
      return {along + offset - error, along + offset + error};
    }
  };

  std::array<EdgeSection, 3> edges_;
};

template <class Visit>
void TriangleSections::visit(double across, std::span<const double> coordinates, double per_unit, std::uint32_t begin,
                             std::uint32_t end, const Visit& visit) const {
  const Interval all{coordinates[begin], coordinates[end - 1]}, nothing{1.0, 0.0};
  std::array<Interval, 4> parts;
  Interval& section = parts[3] = {all.upper, all.lower};
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgeSection& edge = edges_[i];
    const bool meets = edge.extent.lower <= across && across <= edge.extent.upper;
    parts[i] = edge.parallel ? nothing : edge.at(across);
    const bool unknown = !edge.parallel && parts[i].empty();  // overflow
    if (edge.point || (edge.parallel && meets) || unknown) parts[i] = all;
    if (!meets || parts[i].empty()) continue;
    section = {std::min(section.lower, parts[i].lower), std::max(section.upper, parts[i].upper)};
  }
  std::sort(parts.begin(), parts.end(), [](const Interval& a, const Interval& b) { return a.lower < b.lower; });
  std::uint32_t next = begin;
  for (const Interval& part : parts) {
    if (part.empty() || part.lower > all.upper || part.upper < all.lower) continue;
    next = std::max(next, static_cast<std::uint32_t>(count_below(coordinates, per_unit, part.lower)));
    for (; next < end && coordinates[next] <= part.upper; ++next) visit(next);
  }
}

}  // namespace raycone
