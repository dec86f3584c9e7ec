// What evaluators count in 32 bits, where they are asked for more.
#pragma once

#include <stdexcept>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

inline void check_counts(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > kMaxTriangles) throw std::length_error("raycone: more than 2147483647 triangles");
}

inline void check_counts(const LatticeBlock& block) {
  for (const std::int64_t count : block.counts) {
    if (count > kMaxBlockSide)
      throw std::length_error("raycone: a block of more than 4294967295 samples along an axis");
  }
}

}  // namespace raycone
