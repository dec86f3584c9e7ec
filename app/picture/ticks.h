// Round numbers along an axis.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace raycone {

struct Tick {
  double value;
  std::string text;  // of the value less the offset
};

struct Ticks {
  std::vector<Tick> marks;  // rising
  std::string offset;       // " - 1000000000", " + 0.5": to read behind the name of the axis; mostly empty
};

// The multiples of 1, 2 or 5 times a power of ten between two finite values, as many as `fits` accepts, at most twenty.
// Where it accepts no two, one of them. Values far from 0 beside their range get an offset. None where the range is
// empty, or too narrow for double.
[[nodiscard]] Ticks round_ticks(double one_end, double other_end, const std::function<bool(const Ticks&)>& fits);

}  // namespace raycone
