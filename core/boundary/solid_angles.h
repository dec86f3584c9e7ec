// The winding number by its definition, as the sum of the solid angles of all triangles, for meshes that are mostly
// boundary: three square roots per triangle, where the cone takes one per vertex of a chain, one or two per edge.
//
// With p = v - q, a, b, c for the p's of a triangle's corners and n for its normal, 2 pi w is the sum of arg z_T,
//   z_T = |a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b| + i n . a
// (Van Oosterom and Strackee 1983, eq. 8, halved).
#pragma once

#include <vector>

#include "core/boundary/solid_angle_kernel.h"
#include "core/boundary/winding_number_engine.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The triangles of a mesh that have an area, in an order that depends on coordinates only. Those that lie on each other
// with opposite orientations cancel; one that is left n times has n entries.
struct SolidFaces {
  std::vector<SolidTriangle> triangles;
  bool has_repeated_faces = false;  // one is there so often that its error, multiplied, would show
};
// Needs DefaultFloatingPoint. Uses the threads that ThreadLimit allows.
[[nodiscard]] SolidFaces solid_faces(const TriangleMesh& mesh);

// Rounding errors of some u per triangle.
class SolidAngles final : public CompleteEngine {
 public:
  // `boundary`: of the mesh; it must outlive this. Needs DefaultFloatingPoint.
  SolidAngles(const TriangleMesh& mesh, const Boundary& boundary, SimdLevel level);

  // Whether the sum over the triangles is cheaper than the cone over the exterior edges.
  [[nodiscard]] static bool are_cheaper(std::size_t triangles, std::size_t exterior_edges);

  // Whether a face is there so often that its error, multiplied, would show.
  [[nodiscard]] bool has_repeated_faces() const { return faces_.has_repeated_faces; }

  [[nodiscard]] bool counts_crossings() const override { return false; }
  void winding_numbers(SampleTile& samples, std::span<const std::int64_t> crossings,
                       std::span<double> w) const override;

 private:
  SolidAngles(SolidFaces faces, const Boundary& boundary, SimdLevel level);

  SolidAngleKernel multiply_;
  SolidFaces faces_;
};

}  // namespace raycone
