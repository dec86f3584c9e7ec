// Meshes brought to a common place and size.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// What becomes `size` long.
enum class NormalizeTo {
  kCube,    // the longest side of the triangles' box
  kSphere,  // the diameter of the smallest sphere about the box's middle that holds all vertices of triangles
};

struct Normalize {
  NormalizeTo to = NormalizeTo::kCube;
  double size = 1.0;
};

// p becomes factor * (p - middle).
struct Normalization {
  Vec3 middle;
  // 0, infinite or NaN where doubles cannot say it: of a mesh without extent, or a huge or tiny one.
  double factor = 1.0;
};

// Precondition: at least one triangle, finite vertices.
[[nodiscard]] Normalization normalization_of(const TriangleMesh& mesh, const Normalize& normalize);

// Difference and product are each rounded.
void apply(const Normalization& normalization, std::vector<Vec3>& vertices);

}  // namespace raycone
