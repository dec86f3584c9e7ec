// Whether the faces of a border are where their sources are.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/arrangement/rule_border.h"
#include "core/distance/triangle_distance.h"
#include "tests/support/differences.h"

namespace raycone::test {

// How far a corner of a face is from the triangle of the mesh that the face is part of, at most.
inline double farthest_from_source(const RuleBorder& border, const TriangleMesh& mesh) {
  double farthest = 0.0;
  for (std::size_t n = 0; n < border.sources.size(); ++n) {
    const auto& [a, b, c] = mesh.triangles[border.sources[n]];
    const TriangleDistance source(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    for (const std::uint32_t corner : border.mesh.triangles[n]) {
      farthest = larger_difference(farthest, source.squared(border.mesh.vertices[corner]));
    }
  }
  return std::sqrt(farthest);
}

}  // namespace raycone::test
