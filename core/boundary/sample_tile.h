// Samples whose winding numbers are computed together, in SIMD lanes, as the argument of a product of complex factors.
#pragma once

#include <array>
#include <cmath>
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

// How the samples of a tile lie.
enum class TileShape {
  kScattered,  // anyhow; they may share a ray
  kInRows,     // sample 8 j + i is (x_i, y_j, z): rows of eight
};

struct SampleTile {
  alignas(64) Tile x;
  alignas(64) Tile y;
  alignas(64) Tile z;
  std::size_t count = 0;  // samples used; the rest of a group of eight repeats the last one

  void clear() { count = 0; }
  void add(const Vec3& q) {
    x[count] = q.x;
    y[count] = q.y;
    z[count] = q.z;
    ++count;
  }
  [[nodiscard]] Vec3 query(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void fill_up();
  [[nodiscard]] bool share_a_ray() const;  // one y and one z, as along a row of a lattice
};

// Per sample the product of the factors, scaled by a power of two, and where the argument of the running product went.
// Where Im Z changes its sign bit, it has passed 0 or +-pi.
struct ProductTile {
  alignas(64) Tile re;
  alignas(64) Tile im;
  alignas(64) Tile passages;  // of the real axis: each +1 by a factor with Im >= 0, -1 by another; integers
  alignas(64) Tile argument;  // of the whole product, turns

  // Passages of the positive and the negative real axis, with a sign each, become the turns that the argument has
  // completed, which are passages of the negative axis from above (+1) and from below (-1). A, B: passages from above
  // to below with Im f >= 0 and Im f < 0; C, D: from below to above with Im f < 0 and Im f >= 0. The turns are A - C,
  // passages = A + D - B - C, and A + B - C - D is 1 where the product ends below, else 0. Rounding can neither create
  // nor lose a turn (docs/method.md).
  [[nodiscard]] std::int64_t turns(std::size_t i) const {
    return static_cast<std::int64_t>((passages[i] + (std::signbit(im[i]) ? 1.0 : 0.0)) / 2);
  }
};

}  // namespace raycone
