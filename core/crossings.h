// Signed crossings of the rays of a row with triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/row.h"
#include "core/triangle_mesh.h"

namespace raycone {

// What the triangles say about each sample of a row.
struct RowCrossings {
  std::vector<std::int64_t> crossings;   // n(q): triangles crossed by the ray, with the sign of their normal's x
  std::vector<std::int64_t> degenerate;  // edge sides that were ties, once per edge of each triangle whose closed box
                                         // meets the closed ray
  std::vector<std::uint8_t> on_surface;  // 1 where the sample lies on a closed triangle

  // Sets everything to that of the row against the `candidates` of `mesh`: a superset of the triangles whose closed box
  // meets the closed ray from the row's first sample, each once; the result does not depend on their order nor on more
  // of them. Exact.
  void count(const TriangleMesh& mesh, std::span<const std::uint32_t> candidates, const Row& row);

 private:
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row);
  void mark_on_surface(const Vec3& a, const Vec3& b, const Vec3& c, const Row& row, std::size_t begin, std::size_t end);
};

}  // namespace raycone
