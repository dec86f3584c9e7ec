// Samples whose winding numbers are computed together, in SIMD lanes, as the argument of a product of complex factors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/data/vec3.h"

namespace raycone {

// A sum of angles in turns: whole turns and a rest, kept apart so that the whole ones stay exact.
struct Turns {
  std::int64_t whole = 0;
  double rest = 0.0;
};

// Samples that are carried along together; their products and two vertices as seen from them fit the first-level cache.
inline constexpr std::size_t kTile = 64;
using Tile = std::array<double, kTile>;

struct SampleTile {
  alignas(64) Tile x;
  alignas(64) Tile y;
  alignas(64) Tile z;
  std::size_t count = 0;  // samples used; the rest of a group of eight repeats the last one

  void clear() { count = 0; }
  void add(const Vec3& q);
  void fill_up();
  [[nodiscard]] bool share_a_ray() const;  // one y and one z, as along a row of a lattice
};

// Per sample the product of the factors, scaled by a power of two, the turns that its argument has completed, and what
// is left of it, as argument_in_turns() (core/boundary/angle.h).
struct ProductTile {
  alignas(64) Tile re;
  alignas(64) Tile im;
  alignas(64) Tile turns;  // integers
  alignas(64) Tile argument;
};

}  // namespace raycone
