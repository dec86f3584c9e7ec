// What rays say about which side of a face is outside.
#pragma once

#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/orientation/surface_samples.h"

namespace raycone {

// For each sample, from -4 to 4: positive where its face seems to face outward, negative where inward. Rays leave the
// sample along both directions of each axis. A side counts as outside if its ray crosses an even number of other faces;
// it counts by the cosine between the face's normal and the axis. Of closed surfaces all rays are right, whatever the
// orientation of the faces that they cross. Where that would take minutes, only the first of the samples vote: 0 for
// the others. Coordinates in [0, 1]. Exact but for the last rounding. Uses the threads that ThreadLimit allows.
[[nodiscard]] std::vector<double> crossing_votes(const std::vector<Triangle>& faces, const std::vector<Vec3>& vertices,
                                                 const std::vector<SurfaceSample>& samples);

}  // namespace raycone
