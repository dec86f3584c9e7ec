// The winding number by its definition, as the sum of the solid angles of all triangles, for meshes that are mostly
// boundary: three square roots per triangle, where the cone takes as many per exterior edge or two.
//
// With p = v - q, a, b, c for the p's of a triangle's corners and n for its normal, 2 pi w is the sum of arg z_T,
//   z_T = |a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b| + i n . a
// (Van Oosterom and Strackee 1983, eq. 8, halved).
#pragma once

#include <span>
#include <vector>

#include "core/boundary/solid_angle_kernel.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

class SolidAngles {
 public:
  SolidAngles(const TriangleMesh& mesh, SimdLevel level);

  // Whether the sum over the triangles is cheaper than the cone over the exterior edges.
  [[nodiscard]] static bool are_cheaper(std::size_t triangles, std::size_t exterior_edges);

  [[nodiscard]] double triangles() const { return static_cast<double>(triangles_.size()); }

  // Whether a face is there so often that its error, multiplied, would show.
  [[nodiscard]] bool has_crowds() const { return has_crowds_; }

  // Sets w[i] to the winding number at sample i. Rounding errors of some u per triangle; needs DefaultFloatingPoint.
  // Thread-safe. w.size() == samples.count, at least 1.
  void winding_numbers(SampleTile& samples, std::span<Turns> w) const;

 private:
  SolidAngleKernel multiply_;
  bool has_crowds_ = false;
  std::vector<SolidTriangle> triangles_;  // those of positive area, in an order that depends on coordinates only
};

}  // namespace raycone
