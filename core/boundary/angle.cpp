// The arc tangent of t in [0, 1] from that of the nearest c = k / 8: atan t = atan c + atan((t - c) / (1 + t c)), whose
// argument is at most 1/16 in magnitude, so that the Taylor series to the 17th power is off by less than 2^-76 of it.
//
// Error, relative to the result: beyond 1/16 rad the result is at least half the table's entry, whose rounding (u) and
// that of the quotient t (u) thus count double. 1 + t c, the rest's quotient and sum, the product and the final sum add
// a u each. (Some 5.5 u is the most that was found.)
#include "core/boundary/angle.h"

#include <cmath>
#include <cstddef>

namespace raycone {
namespace {

template <class Real>
Real small_arc_tangent(Real t) {
  const Real s = t * t;
  Real tail = 0;
  for (int power = 17; power >= 3; power -= 2) tail = s * ((power % 4 == 1 ? Real(1) : Real(-1)) / Real(power) + tail);
  return t + t * tail;
}

template <class Real>
Real arc_tangent_in_turns(Real t) {
  const Real k = std::nearbyint(8 * t);
  const Real c = k / 8;
  const Real rest = (t - c) / (1 + t * c);
  return static_cast<Real>(kArcTangentsInTurns[static_cast<std::size_t>(k)]) +
         static_cast<Real>(kTurnsPerRadian) * small_arc_tangent(rest);
}

}  // namespace

template <class Real>
Real argument_in_turns(Real re, Real im) {
  const Real x = std::abs(re), y = std::abs(im);
  const Real octant = arc_tangent_in_turns(y <= x ? y / x : x / y);
  const Real quadrant = y <= x ? octant : Real(0.25) - octant;
  return std::copysign(std::signbit(re) ? Real(0.5) - quadrant : quadrant, im);
}

template double argument_in_turns<double>(double, double);
template long double argument_in_turns<long double>(long double, long double);

}  // namespace raycone
