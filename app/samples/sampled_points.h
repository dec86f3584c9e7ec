// Points that the tool draws, in place of a file of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "app/options/points_command.h"
#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"
#include "io/points/read_points.h"

namespace raycone {

// Draws points as `request` says. `name`: the file that `mesh` is from; `precision`: of the points' coordinates. Throws
// UsageError where the padding leaves nothing of the box, InputError where points on or near the surface are asked for
// and no triangle has an area, LimitError where points would not be finite.
[[nodiscard]] std::unique_ptr<PointReader> draw_points(const std::string& name, const TriangleMesh& mesh,
                                                       const SampleRequest& request, CoordinatePrecision precision);

// Whether some of the points lie on the surface, so that they have normals and faces.
[[nodiscard]] bool draws_on_surface(const SampleRequest& request);

// How many lie elsewhere: in the box, or near the surface, by up to a quarter of the mesh's diagonal as a rule.
[[nodiscard]] std::uint64_t points_around_mesh(const SampleRequest& request);

}  // namespace raycone
