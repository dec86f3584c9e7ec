// The inner loop of the boundary cone: products of factors over many samples at once, in SIMD lanes.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/simd.h"
#include "core/vec3.h"

namespace raycone {

// Exterior edges of one |multiplicity| as chains of vertices.
struct ChainStep {
  Vec3 to;
  bool joined;    // the edge from the previous step's vertex to this one is there; else a chain begins here
  bool reversed;  // its multiplicity is negative
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
// is left of it, as argument_in_turns() (core/angle.h).
struct ProductTile {
  alignas(64) Tile re;
  alignas(64) Tile im;
  alignas(64) Tile turns;  // integers
  alignas(64) Tile argument;
};

// Multiplies the factors of all edges at all samples. One lane is one sample, and its operations come in one order,
// without fused multiply-add: results are the same for every SIMD level. Needs DefaultFloatingPoint. Thread-safe.
using ConeKernel = void (*)(std::span<const ChainStep> steps, const SampleTile& samples, ProductTile& products);

// That of the level, of the best one where the level is not available.
[[nodiscard]] ConeKernel cone_kernel(SimdLevel level);

}  // namespace raycone
