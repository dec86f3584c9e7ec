#include "io/vdb/stored_values.h"

#include <limits>

#include "io/files/half.h"

namespace raycone::vdb {

bool has_chosen_precision(FieldKind kind) {
  return kind == FieldKind::kReal || kind == FieldKind::kDensity || kind == FieldKind::kDistance ||
         kind == FieldKind::kVector;
}

template <typename Value>
Value level_set_background(double band_width, double voxel, Precision precision) {
  auto background = static_cast<Value>(band_width);
  const auto stored = [&] {
    if (precision != Precision::kHalf) return background;
    return static_cast<Value>(nearest_half(static_cast<double>(background)));
  };
  while (static_cast<double>(stored()) / voxel < band_width / voxel) {
    background = std::nextafter(std::max(background, stored()), std::numeric_limits<Value>::infinity());
  }
  return stored();
}

template <typename Value>
Value next_within(Value background, Precision precision) {
  if (precision == Precision::kHalf) return -static_cast<Value>(next_half_above(-static_cast<float>(background)));
  return std::nextafter(background, Value{0});
}

template float next_within(float, Precision);
template double next_within(double, Precision);

template float level_set_background(double, double, Precision);
template double level_set_background(double, double, Precision);

}  // namespace raycone::vdb
