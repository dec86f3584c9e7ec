#include "io/vdb/stored_values.h"

#include <limits>

#include "io/files/half.h"

namespace raycone::vdb {
bool has_chosen_precision(FieldKind kind) {
  return kind == FieldKind::kReal || kind == FieldKind::kDensity || kind == FieldKind::kDistance ||
         kind == FieldKind::kVector;
}

Narrowing narrowing_of(const FieldDescription& field, bool half) {
  if (!half) return Narrowing(field);
  return {field, &nearest_half, &next_half_above};
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

template float level_set_background(double, double, bool);
template double level_set_background(double, double, bool);

}  // namespace raycone::vdb
