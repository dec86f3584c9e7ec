#include "io/fields/narrowing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "io/files/half.h"

namespace raycone {
namespace {

// Of what a float can hold. The sum rounds to a whole number, without a branch.
bool is_half_integer(double number) { return std::abs(number - ((number + 0x1.8p52) - 0x1.8p52)) == 0.5; }

bool are_equal(std::span<const double> values, const float* nearest) {
  int differ = 0;
  for (std::size_t n = 0; n < values.size(); ++n)
    differ |= static_cast<int>(static_cast<double>(nearest[n]) != values[n]);
  return differ == 0;
}

}  // namespace

Narrowing::Narrowing(const FieldDescription& field, Digits digits)
    : digits_(digits),
      keeps_sides_(field.kind == FieldKind::kReal || field.kind == FieldKind::kDensity),
      keeps_negative_(field.kind == FieldKind::kDistance),
      is_bound_(field.kind == FieldKind::kBound),
      is_clamped_(field.kind == FieldKind::kVector),
      of_magnitude_(field.threshold_of_magnitude),
      threshold_(field.threshold) {
  const auto as_float = static_cast<double>(static_cast<float>(threshold_));
  low_ = std::min({threshold_, as_float, as_stored(threshold_)});
  high_ = std::max({threshold_, as_float, as_stored(threshold_)});
}

float Narrowing::up(float value) const {
  return digits_ == Digits::kHalf ? next_half_above(value)
                                  : std::nextafter(value, std::numeric_limits<float>::infinity());
}

// The threshold as readers have it who compare in the precision of what is stored; itself beyond that.
double Narrowing::as_stored(double threshold) const {
  const float stored = nearest(threshold), size = std::abs(stored);
  return up(size) == size ? threshold : static_cast<double>(stored);
}

float Narrowing::on_side(float stored, double value) const {
  const double number = stored;
  if (is_half_integer(number) && (number > value || number < 0.0)) {
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

// The nearest ones are right nearly always, and compilers put them and the question whether they are into lanes.
void Narrowing::store(std::span<const double> values, float* stored) const {
  constexpr std::size_t kPiece = 256;
  for (std::size_t begin = 0; begin < values.size(); begin += kPiece) {
    const std::span<const double> piece = values.subspan(begin, std::min(kPiece, values.size() - begin));
    float* const of_piece = stored + begin;
    store_nearest(piece, of_piece);
    if (are_right(piece, of_piece)) continue;
    for (std::size_t n = 0; n < piece.size(); ++n) of_piece[n] = (*this)(piece[n]) + 0.0F;
  }
}

void Narrowing::store_nearest(std::span<const double> values, float* stored) const {
  if (digits_ == Digits::kHalf) {
    for (std::size_t n = 0; n < values.size(); ++n) stored[n] = nearest_half(values[n]) + 0.0F;
  } else if (is_clamped_) {
    for (std::size_t n = 0; n < values.size(); ++n) stored[n] = nearest(values[n]) + 0.0F;
  } else {
    for (std::size_t n = 0; n < values.size(); ++n) stored[n] = static_cast<float>(values[n]) + 0.0F;
  }
}

// Whether all of the nearest are surely what is to be stored. There is no early exit, so that
// compilers can use lanes.
bool Narrowing::are_right(std::span<const double> values, const float* nearest) const {
  if (are_equal(values, nearest)) return true;  // as they mostly are in closed meshes
  int wrong = 0;
  if (is_bound_) {
    for (std::size_t n = 0; n < values.size(); ++n)
      wrong |= static_cast<int>(static_cast<double>(nearest[n]) < values[n]);
  } else if (keeps_negative_) {
    for (std::size_t n = 0; n < values.size(); ++n) {
      wrong |= static_cast<int>(values[n] < 0.0) & static_cast<int>(nearest[n] == 0.0F);
    }
  } else if (keeps_sides_) {
    return are_on_their_sides(values, nearest);
  }
  return wrong == 0;
}

bool Narrowing::are_on_their_sides(std::span<const double> values, const float* nearest) const {
  int wrong = 0;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const double number = nearest[n], value = values[n];
    const double stored = of_magnitude_ ? std::abs(number) : number;
    const bool reaches = (of_magnitude_ ? std::abs(value) : value) >= threshold_;
    const int crosses = reaches ? static_cast<int>(stored < high_) : static_cast<int>(stored >= low_);
    wrong |= static_cast<int>(number != value) & (crosses | static_cast<int>(is_half_integer(number)));
  }
  return wrong == 0;
}

}  // namespace raycone
