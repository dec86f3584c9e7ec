// The cone's winding number in extended precision, with a rigorous bound of its error.
#pragma once

#include <cstdint>
#include <span>

#include "core/boundary/chain.h"
#include "core/data/vec3.h"

namespace raycone {

// A sum of angles in turns, kept in two parts as in Turns, and how far it may be off.
template <class Real>
struct TurnsWithin {
  std::int64_t whole = 0;
  Real rest = 0;
  Real bound = 0;  // of |whole + rest - the exact sum|, turns
};

// The winding number of the cone over the edges (core/boundary/cone.h), sign as in w = n - w_cone. It shares the signs
// of the sides and the order of the edges with the sum in double precision, not the arithmetic: a check of that. A
// hundred times slower. Needs DefaultFloatingPoint. Thread-safe.
[[nodiscard]] TurnsWithin<long double> enclose_in_64_bits(std::span<const ChainGroup> groups, const Vec3& q);

}  // namespace raycone
