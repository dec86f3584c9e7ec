// The numbers of a sample under the names that users know.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/fields/sample_draw.h"

namespace raycone {

struct NamedNumber {
  std::string name;
  double number;
};

// By axis.
inline constexpr std::array kGradientNames{"gradient_x", "gradient_y", "gradient_z"};

// Those of the signed distances that the sample has.
[[nodiscard]] std::vector<NamedNumber> distances_of(const DrawnSample& sample);

// All that the sample has but its label, in one order.
[[nodiscard]] std::vector<NamedNumber> numbers_of(const DrawnSample& sample);

}  // namespace raycone
