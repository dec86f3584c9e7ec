#include "app/fields/named_numbers.h"

#include <cstddef>

namespace raycone {

std::vector<NamedNumber> distances_of(const DrawnSample& sample) {
  std::vector<NamedNumber> distances;
  if (sample.distance) distances.push_back({"sdf", *sample.distance});
  if (sample.solid) distances.push_back({"solid", *sample.solid});
  return distances;
}

std::vector<NamedNumber> numbers_of(const DrawnSample& sample) {
  std::vector<NamedNumber> numbers;
  if (sample.winding) numbers.push_back({"winding", *sample.winding});
  if (sample.inside) numbers.push_back({"inside", *sample.inside ? 1.0 : 0.0});
  if (sample.density) numbers.push_back({"density", *sample.density});
  for (const NamedNumber& distance : distances_of(sample)) numbers.push_back(distance);
  for (int axis = 0; sample.gradient && axis < 3; ++axis) {
    numbers.push_back({kGradientNames[static_cast<std::size_t>(axis)], (*sample.gradient)[axis]});
  }
  return numbers;
}

}  // namespace raycone
