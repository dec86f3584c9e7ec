// Whether a mesh is what `info --require` asks for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/options/info_command.h"
#include "core/data/triangle_mesh.h"
#include "core/intersections/self_intersections.h"
#include "core/mesh/mesh_statistics.h"
#include "core/orientation/mesh_defects.h"

namespace raycone {

// Intersecting pairs of triangles as far as they are known.
struct FoundIntersections {
  std::optional<TrianglePair> first;
  std::optional<std::uint64_t> pairs;  // nothing where only the first was looked for
};

// The requirements that the welded mesh does not meet, each with how often and where: "closed: 3 exterior edges, the
// first from (0, 0, 0) to (1, 0, 0) of face 0; embedded: ...". Empty where it meets all. Faces count from 0, after
// polygons are cut into triangles.
[[nodiscard]] std::string unmet_requirements(const std::vector<Requirement>& required, const TriangleMesh& mesh,
                                             const MeshStatistics& statistics, const MeshDefects& defects,
                                             const FoundIntersections& intersections);

}  // namespace raycone
