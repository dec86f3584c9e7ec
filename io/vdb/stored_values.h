// What grids keep of the numbers of a field. Each type here turns a field's Number into a grid's Stored value.
// StoreFloat also takes many at once, which is faster.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "io/fields/field_writer.h"
#include "io/fields/narrowing.h"

namespace raycone::vdb {

// Whether the user chooses the precision of fields of this kind: of all but diagnostics.
[[nodiscard]] bool has_chosen_precision(FieldKind kind);

// The least value of a precision that is no narrower than the band, also as OpenVDB's checkLevelSet measures it: in
// voxels. Value: double for Precision::kDouble, else float.
template <typename Value>
[[nodiscard]] Value level_set_background(double band_width, double voxel, Precision precision);

// The next such value towards 0.
template <typename Value>
[[nodiscard]] Value next_within(Value background, Precision precision);

// A byte, as several threads cannot write to the bits of one.
struct StoreFlag {
  using Number = std::uint8_t;
  using Stored = std::uint8_t;
  Stored operator()(Number flag) const { return flag; }
};

struct StoreLabel {
  using Number = std::int32_t;
  using Stored = std::int32_t;
  Stored operator()(Number label) const { return label; }
};

// Floats: pyopenvdb reads no file that holds a grid of integers.
struct StoreCount {
  using Number = std::int64_t;
  using Stored = float;
  Stored operator()(Number count) const { return static_cast<float>(static_cast<double>(count)); }
};

// Adding 0 turns -0 into 0, here and below.
struct StoreFloat {
  using Number = double;
  using Stored = float;
  Stored operator()(Number number) const { return narrowing(number) + 0.0F; }
  void operator()(std::span<const Number> numbers, Stored* stored) const { narrowing.store(numbers, stored); }
  Narrowing narrowing;
};

struct StoreDouble {
  using Number = double;
  using Stored = double;
  Stored operator()(Number number) const { return number + 0.0; }
};

// A distance of `band_width` or more is stored as the background, a lesser one as a value of lesser magnitude. Store:
// of lesser ones, StoreFloat or StoreDouble; it keeps negative ones negative. `most`: next_within() the background.
template <typename Store>
struct StoreDistance {
  using Number = double;
  using Stored = typename Store::Stored;
  Stored operator()(Number distance) const {
    if (std::abs(distance) >= band_width) return distance < 0 ? -background : background;
    return std::clamp(store(distance), -most, most);
  }
  double band_width;
  Stored background, most;
  Store store;
};

template <typename Store>
inline constexpr bool kIsDistance = false;
template <typename Store>
inline constexpr bool kIsDistance<StoreDistance<Store>> = true;

}  // namespace raycone::vdb
