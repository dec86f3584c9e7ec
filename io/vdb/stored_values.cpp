#include "io/vdb/stored_values.h"

#include <limits>

#include "io/files/half.h"

namespace raycone::vdb {

bool has_chosen_precision(FieldKind kind) {
  return kind == FieldKind::kReal || kind == FieldKind::kDensity || kind == FieldKind::kDistance ||
         kind == FieldKind::kVector;
}

template <typename Value>
Value level_set_background(double band_width, double voxel, bool half) {
  auto background = static_cast<Value>(band_width);
  const auto stored = [&] {
    return half ? static_cast<Value>(nearest_half(static_cast<double>(background))) : background;
  };
  while (static_cast<double>(stored()) / voxel < band_width / voxel) {
    background = std::nextafter(std::max(background, stored()), std::numeric_limits<Value>::infinity());
  }
  return stored();
}

template <typename Value>
Value next_within(Value background, bool half) {
  if (half) return -static_cast<Value>(next_half_above(-static_cast<float>(background)));
  return std::nextafter(background, Value{0});
}

template float next_within(float, bool);
template double next_within(double, bool);

template float level_set_background(double, double, bool);
template double level_set_background(double, double, bool);

}  // namespace raycone::vdb
