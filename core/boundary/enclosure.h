// The cone's winding number in extended precision, with a rigorous bound of its error.
#pragma once

#include <cstdint>
#include <span>

#include "core/boundary/chain.h"
#include "core/boundary/sample_tile.h"
#include "core/data/vec3.h"
#include "core/exact/quad.h"

namespace raycone {

// A sum of angles in turns, kept in two parts as in Turns, and how far it may be off.
struct TurnsWithin {
  std::int64_t whole = 0;
  Quad rest = 0;
  Quad bound = 0;  // of |whole + rest - the exact sum|, turns
};

// What follows is the winding number of the cone over the edges (core/boundary/cone.h), sign as in w = n - w_cone. It
// shares the signs of the sides and the order of the edges with the sum in double precision, not the arithmetic: a
// check of that. Needs DefaultFloatingPoint. Thread-safe.

// Of each sample, by pairs of doubles; some ten to thirty times slower than in double precision where tiles are full. A
// bound is some 1e-28 turns per edge, and infinite where a factor is out of their range.
void enclose_in_106_bits(std::span<const ChainGroup> groups, SampleTile& samples, std::span<TurnsWithin> cones);

// A hundred times slower still. The bound is some 1e-32 turns per edge, never infinite.
[[nodiscard]] TurnsWithin enclose_in_113_bits(std::span<const ChainGroup> groups, const Vec3& q);

// In 106 bits or, where that has no bound, in 113.
void enclose(std::span<const ChainGroup> groups, SampleTile& samples, std::span<TurnsWithin> cones);

}  // namespace raycone
