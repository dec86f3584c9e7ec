// Samples that share one ray.
#pragma once

#include <span>

#include "core/vec3.h"

namespace raycone {

// The queries (x, y, z) for all x of xs, ascending: their rays along +x lie on one line. A single query is a row of
// one.
struct Row {
  double y = 0.0;
  double z = 0.0;
  std::span<const double> xs;

  [[nodiscard]] Vec3 query(std::size_t i) const { return {xs[i], y, z}; }
};

}  // namespace raycone
