// The cone's winding number in extended precision, with a rigorous bound of its error.
#pragma once

#include <cstdint>
#include <span>

#include "core/boundary/chain.h"
#include "core/data/vec3.h"
#include "core/exact/quad.h"

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
// hundred times slower with 64 bits, thousands of times with 113. Needs DefaultFloatingPoint. Thread-safe.
template <class Real>  // long double or Quad
[[nodiscard]] TurnsWithin<Real> enclose(std::span<const ChainGroup> groups, const Vec3& q);

}  // namespace raycone
