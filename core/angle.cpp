// The arc tangent of t in [0, 1] from that of the nearest c = k / 8: atan t = atan c + atan((t - c) / (1 + t c)), whose
// argument is at most 1/16 in magnitude, so that the Taylor series to the 13th power is off by less than 2^-63 of it.
#include "core/angle.h"

#include <array>
#include <cmath>

namespace raycone {
namespace {

// atan(k / 8) / (2 pi), rounded.
constexpr std::array<double, 9> kTableInTurns = {
    0.0,
    0x1.4444750777668p-6,
    0x1.3f670b6bdc73dp-5,
    0x1.d3c3a482f3ab5p-5,
    0x1.2e4051d9df308p-4,
    0x1.6c266f6edfc1ep-4,
    0x1.a37f5c4c419efp-4,
    0x1.d49ab3ac8b1bbp-4,
    0.125,
};
constexpr double kTurnsPerRadian = 0x1.45f306dc9c883p-3;

double small_arc_tangent(double t) {
  const double s = t * t;
  const double tail =
      s * (-1.0 / 3 + s * (1.0 / 5 + s * (-1.0 / 7 + s * (1.0 / 9 + s * (-1.0 / 11 + s * (1.0 / 13))))));
  return t + t * tail;
}

double arc_tangent_in_turns(double t) {
  const double k = std::nearbyint(8.0 * t);
  const double c = k / 8.0;
  const double rest = (t - c) / (1.0 + t * c);
  return kTableInTurns[static_cast<std::size_t>(k)] + kTurnsPerRadian * small_arc_tangent(rest);
}

}  // namespace

double argument_in_turns(double re, double im) {
  const double x = std::abs(re), y = std::abs(im);
  const double octant = arc_tangent_in_turns(y <= x ? y / x : x / y);
  const double quadrant = y <= x ? octant : 0.25 - octant;
  return std::copysign(std::signbit(re) ? 0.5 - quadrant : quadrant, im);
}

}  // namespace raycone
