#include "core/sampling/random.h"

#include <array>
#include <cmath>

#include "core/data/split_mix.h"

namespace raycone {
namespace {

// Natural logarithm of x > 0, to some 1e-16: 2 artanh z = 2 (z + z^3 / 3 + z^5 / 5 + ...) with z = (m - 1) / (m + 1),
// |z| < 0.172, of the significand m.
double logarithm(double x) {
  constexpr double kLog2 = 0x1.62e42fefa39efp-1, kSqrtHalf = 0x1.6a09e667f3bcdp-1;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < kSqrtHalf) {
    m *= 2;
    --exponent;
  }
  constexpr std::array kInverses{1.0 / 23, 1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13,
                                 1.0 / 11, 1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
  const double z = (m - 1) / (m + 1), square = z * z;
  double series = 0.0;
  for (const double inverse : kInverses) series = series * square + inverse;
  return exponent * kLog2 + 2 * z * series;
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream)
    : state_(split_mix(split_mix(seed + kSplitMixStep) + stream * kSplitMixStep)) {}

std::uint64_t Random::bits() { return split_mix(state_ += kSplitMixStep); }

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

// Marsaglia's polar method: a uniform point of the unit disc makes two.
double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0.0, v = 0.0, square = 0.0;
  do {
    u = 2 * uniform() - 1;
    v = 2 * uniform() - 1;
    square = u * u + v * v;
  } while (square >= 1.0 || square == 0.0);
  const double factor = std::sqrt(-2 * logarithm(square) / square);
  spare_ = v * factor;
  has_spare_ = true;
  return u * factor;
}

}  // namespace raycone
