// Doubles stored with fewer digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "io/fields/field_writer.h"
#include "io/files/half.h"

namespace raycone {

enum class Digits { kSingle, kHalf };  // 32 and 16 bits

// Rounds the numbers of a field to float so that no rule decides otherwise about what is stored: a float is on the same
// side of the field's threshold as the double it stands for, compared as it is stored, as float or as double, and
// likewise of every half-integer, unless the threshold forbids it: a positive one stands only for numbers that reach
// it, a negative one, which some rules compare by magnitude, only for itself. Half-integers beyond 2^23 are not floats.
// Where a threshold lies beyond all that can be stored, numbers beyond that become the largest on their side of 0.
// Negative distances stay negative, and bounds are rounded up. What needs no rounding stays as it is, also where a
// threshold becomes equal to it.
class Narrowing {
 public:
  explicit Narrowing(const FieldDescription& field, Digits digits = Digits::kSingle);

  // With Digits::kHalf one of those floats that are halves.
  [[nodiscard]] float operator()(double value) const;

  // Sets stored[n] to what it makes of values[n], with -0 as 0.
  void store(std::span<const double> values, float* stored) const;

 private:
  [[nodiscard]] float nearest(double value) const;
  [[nodiscard]] float up(float value) const;  // the next one that can be stored; of the largest, that
  [[nodiscard]] float down(float value) const { return -up(-value); }
  [[nodiscard]] double as_stored(double threshold) const;
  [[nodiscard]] float on_side(float stored, double value) const;

  void store_nearest(std::span<const double> values, float* stored) const;
  [[nodiscard]] bool are_right(std::span<const double> values, const float* nearest) const;
  [[nodiscard]] bool are_on_their_sides(std::span<const double> values, const float* nearest) const;

  Digits digits_;
  bool keeps_sides_;
  bool keeps_negative_;
  bool is_bound_;
  bool is_clamped_;
  bool of_magnitude_;
  double threshold_;
  double low_ = 0.0, high_ = 0.0;  // the threshold as readers may have it: no stored number is between
};

inline float Narrowing::nearest(double value) const {
  if (digits_ == Digits::kHalf) return nearest_half(value);
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(is_clamped_ ? std::clamp(value, -kMost, kMost) : value);
}

inline float Narrowing::operator()(double value) const {
  const float stored = nearest(value);
  if (is_bound_) return static_cast<double>(stored) < value ? up(stored) : stored;
  if (keeps_negative_) return value < 0.0 && stored == 0.0F ? down(0.0F) : stored;
  if (!keeps_sides_ || static_cast<double>(stored) == value) return stored;
  if (of_magnitude_) return std::copysign(on_side(std::abs(stored), std::abs(value)), static_cast<float>(value));
  return on_side(stored, value);
}

}  // namespace raycone
