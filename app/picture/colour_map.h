// Colours of values on either side of a centre.
#pragma once

#include <span>
#include <vector>

#include "app/picture/image.h"

namespace raycone {

// Values from centre - half_width to centre + half_width; those beyond have the colour of the ends.
struct ColourRange {
  double centre = 0.5;  // where inside and outside part
  double half_width = 1.0;
  bool inside_below = false;    // inside is where values are less
  bool exceeded_below = false;  // some values are beyond
  bool exceeded_above = false;

  [[nodiscard]] double least() const { return centre - half_width; }
  [[nodiscard]] double most() const { return centre + half_width; }
};

// Of winding numbers: the narrowest range of at least [-0.5, 1.5] that ends at half-integers or integers and leaves out
// at most one value in two hundred: a few large numbers must not make all others look alike.
[[nodiscard]] ColourRange colour_range(std::span<const double> values);

// Of signed distances: the narrowest range around 0 that holds all finite ones.
[[nodiscard]] ColourRange distance_colour_range(std::span<const double> distances);

// Diverging: white at the centre, to dark blue outside and dark red inside. Lightness falls evenly with the distance
// from the centre, in OKLab; hence the distance is seen with any colour blindness too.
class ColourMap {
 public:
  explicit ColourMap(const ColourRange& range);

  [[nodiscard]] const ColourRange& range() const { return range_; }
  [[nodiscard]] Rgb operator()(double value) const;

 private:
  ColourRange range_;
  std::vector<Rgb> colours_;  // evenly over the range, from outside to inside
};

}  // namespace raycone
