// What the rays of many points cross, found by one pass over the triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/crossings/binned_rays.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// By the number of a ray.
struct PointCrossings {
  std::vector<std::int64_t> n;           // the sum of the signs of its crossings
  std::vector<std::uint64_t> ties;       // edges with D = 0, of triangles whose closed box it meets
  std::vector<std::uint8_t> on_surface;  // whether its origin lies on a closed triangle: 1, else 0

  explicit PointCrossings(std::size_t rays) : n(rays), ties(rays), on_surface(rays) {}
};

// Whether the crossings of points are found so: the mesh has no grid of rays, nor Embree.
[[nodiscard]] bool takes_passes(const ScaledMesh& mesh);

// Those of rays numbered from 0 to below `count`, which start in the scale of the mesh. None where triangles meet so
// many of the rays that a grid is cheaper: then it is built. Only before loops over points. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<PointCrossings> crossings_by_pass(const ScaledMesh& mesh, std::vector<NumberedRay> rays,
                                                              std::size_t count);

}  // namespace raycone
