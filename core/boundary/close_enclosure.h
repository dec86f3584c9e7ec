// The cone's winding number where 64 bits cannot tell it from a half-integer.
#pragma once

#include <span>

#include "core/boundary/enclosure.h"
#include "core/exact/quad.h"

namespace raycone {

// As enclose_in_64_bits(), in as much time, by pairs of doubles. The bound is some 1e-28 turns per edge, and infinite
// where a factor is out of their range.
[[nodiscard]] TurnsWithin<Quad> enclose_in_106_bits(std::span<const ChainGroup> groups, const Vec3& q);

// The same with a bound of some 1e-32 turns per edge, never infinite; thirty times as slow.
[[nodiscard]] TurnsWithin<Quad> enclose_in_113_bits(std::span<const ChainGroup> groups, const Vec3& q);

}  // namespace raycone
