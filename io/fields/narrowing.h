// Doubles stored with fewer digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/fields/field_writer.h"

namespace raycone {

// Rounds the numbers of a field to float so that no rule decides otherwise about what is stored: a float is on the same
// side of the field's threshold as the double it stands for, compared as it is stored, as float or as double, and
// likewise of every half-integer, unless the threshold forbids it: a positive one stands only for numbers that reach
// it, a negative one, which some rules compare by magnitude, only for itself. Half-integers beyond 2^23 are not floats.
// Where a threshold lies beyond all that can be stored, numbers beyond that become the largest on their side of 0.
// Negative distances stay negative, and bounds are rounded up. What needs no rounding stays as it is, also where a
// threshold becomes equal to it.
class Narrowing {
 public:
  explicit Narrowing(const FieldDescription& field)
      : Narrowing(field, field.kind == FieldKind::kVector ? &float_in_range : &nearest_float, &next_float) {}

  // `nearest`: the stored value nearest to a double, itself a float; `next`: the stored value after another, upwards,
  // or itself where it is the largest.
  Narrowing(const FieldDescription& field, float (*nearest)(double), float (*next)(float))
      : keeps_sides_(field.kind == FieldKind::kReal || field.kind == FieldKind::kDensity),
        keeps_negative_(field.kind == FieldKind::kDistance),
        is_bound_(field.kind == FieldKind::kBound),
        of_magnitude_(field.threshold_of_magnitude),
        threshold_(field.threshold),
        low_(std::min(
            {threshold_, static_cast<double>(static_cast<float>(threshold_)), stored(threshold_, nearest, next)})),
        high_(std::max(
            {threshold_, static_cast<double>(static_cast<float>(threshold_)), stored(threshold_, nearest, next)})),
        nearest_(nearest),
        next_(next) {}

  [[nodiscard]] float operator()(double value) const {
    const float stored = nearest_(value);
    if (is_bound_) return static_cast<double>(stored) < value ? up(stored) : stored;
    if (keeps_negative_ && value < 0.0) return std::min(stored, down(0.0F));
    if (!keeps_sides_ || static_cast<double>(stored) == value) return stored;
    if (of_magnitude_) return std::copysign(on_side(std::abs(stored), std::abs(value)), stored);
    return on_side(stored, value);
  }

 private:
  static float nearest_float(double value) { return static_cast<float>(value); }
  static float float_in_range(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kMost, kMost));
  }
  // The threshold as readers have it who compare in the precision of what is stored; itself beyond that.
  static double stored(double threshold, float (*nearest)(double), float (*next)(float)) {
    const float as_stored = nearest(threshold), size = std::abs(as_stored);
    return next(size) == size ? threshold : static_cast<double>(as_stored);
  }
  static float next_float(float value) { return std::nextafter(value, std::numeric_limits<float>::infinity()); }
  [[nodiscard]] float up(float value) const { return next_(value); }
  [[nodiscard]] float down(float value) const { return -next_(-value); }

  [[nodiscard]] float on_side(float stored, double value) const {
    const double number = stored, nearest_integer = (number + 0x1.8p52) - 0x1.8p52;
    if (std::abs(number - nearest_integer) == 0.5 && (number > value || number < 0.0)) {
      stored = number > value ? down(stored) : up(stored);
    }
    const bool reaches = value >= threshold_;
    while (reaches ? static_cast<double>(stored) < high_ : static_cast<double>(stored) >= low_) {
      const float next = reaches ? up(stored) : down(stored);
      if (next == stored) break;
      stored = next;
    }
    return stored;
  }

  bool keeps_sides_;
  bool keeps_negative_;
  bool is_bound_;
  bool of_magnitude_;
  double threshold_, low_, high_;
  float (*nearest_)(double);
  float (*next_)(float);
};

}  // namespace raycone
