// The enclosure of a cone from those of its groups of edges.
#pragma once

#include <span>

#include "core/boundary/chain.h"
#include "core/boundary/enclosure.h"

namespace raycone {

// `rounding` bounds what a group's rest, its multiple and the sum round, relative to the two. Real: long double or
// Quad.
template <class Real, class EncloseGroup>
TurnsWithin<Real> sum_of_groups(std::span<const ChainGroup> groups, Real rounding, const EncloseGroup& enclose_one) {
  const auto magnitude = [](Real x) { return x < 0 ? -x : x; };
  TurnsWithin<Real> sum;
  for (const ChainGroup& group : groups) {
    const TurnsWithin<Real> turns = enclose_one(group);
    const Real rest = group.multiplicity * turns.rest;
    sum.whole += group.multiplicity * turns.whole;
    sum.rest += rest;
    sum.bound += group.multiplicity * turns.bound + rounding * (magnitude(rest) + magnitude(sum.rest));
  }
  return sum;
}

}  // namespace raycone
