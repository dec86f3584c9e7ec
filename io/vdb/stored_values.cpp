#include "io/vdb/stored_values.h"

#include <openvdb/Types.h>

#include <limits>

namespace raycone::vdb {
namespace {

using openvdb::math::half;

// The value of 16 bits that OpenVDB stores for `value`, within their range.
float as_half(float value) {
  const float largest = std::numeric_limits<half>::max();
  return half(std::clamp(value, -largest, largest));
}

// The next value of 16 bits, upwards.
float next_half(float value) {
  half next(value);
  const unsigned short bits = next.bits();
  constexpr unsigned short kSign = 0x8000;
  const bool negative = (bits & kSign) != 0 && bits != kSign;
  next.setBits(static_cast<unsigned short>(negative ? bits - 1 : (bits & ~kSign) + 1));
  return next;
}

}  // namespace

bool has_chosen_precision(FieldKind kind) {
  return kind == FieldKind::kReal || kind == FieldKind::kDensity || kind == FieldKind::kDistance ||
         kind == FieldKind::kVector;
}

Narrowing narrowing_of(const FieldDescription& field, bool half) {
  if (!half) return Narrowing(field);
  return {field, [](double value) { return as_half(static_cast<float>(value)); }, &next_half};
}

float rounded_up(double bound) {
  const float nearest = static_cast<float>(bound);
  return static_cast<double>(nearest) < bound ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                              : nearest;
}

template <typename Value>
Value level_set_background(double band_width, double voxel, bool half) {
  auto background = static_cast<Value>(band_width);
  const auto stored = [&] { return half ? static_cast<Value>(as_half(static_cast<float>(background))) : background; };
  while (static_cast<double>(stored()) / voxel < band_width / voxel) {
    background = std::nextafter(std::max(background, stored()), std::numeric_limits<Value>::infinity());
  }
  return stored();
}

template float level_set_background(double, double, bool);
template double level_set_background(double, double, bool);

}  // namespace raycone::vdb
