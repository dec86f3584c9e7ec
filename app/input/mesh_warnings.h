// Warnings about a mesh that is read well, but gives results that its owner may not expect.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/placed_lattice.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/data/warning.h"
#include "core/orientation/mesh_defects.h"
#include "core/orientation/orient.h"

namespace raycone {

// `reversed`, `inconsistent`, `opposite-duplicates`, in this order, those that apply to a mesh that was turned so.
[[nodiscard]] std::vector<Warning> warnings_about(const MeshDefects& defects, Orient orient);

// The number of triangles that have three corners at different positions: less of it after welding is what a distance
// took away.
[[nodiscard]] std::uint64_t triangles_with_corners(const TriangleMesh& mesh);

// `weld-collapsed`: `faces` (not 0) lost their area to `distance`.
[[nodiscard]] Warning weld_collapsed(std::uint64_t faces, double distance);

// `unorientable`, `walls`, in this order, those that apply to meshes that were turned: of several, the counts added up.
[[nodiscard]] std::vector<Warning> warnings_about(const OrientationCounts& counts);

// Whether a mesh in `box` has a volume to be found: the box is not flat.
[[nodiscard]] bool may_have_inside(const Box& box);

// Whether no inside sample of `lattice` says something about the mesh in `box`: may_have_inside(box), and the lattice
// reaches around it but for a voxel.
[[nodiscard]] bool should_have_inside(const Box& box, const PlacedLattice& lattice);

// `tolerance`, where values are promised within `bound` only: 0 of closed meshes. A tolerance that counts as 0 asks for
// no promise.
[[nodiscard]] std::optional<Warning> tolerance_not_kept(double tolerance, double bound);

// `empty`, of a mesh in `box` that was turned so.
[[nodiscard]] Warning nothing_inside(const Rule& rule, Orient orient, const Box& box, const PlacedLattice& lattice);

// `empty`, of a mesh that was turned so, where points are drawn in its box or near its surface.
[[nodiscard]] Warning no_point_inside(const Rule& rule, Orient orient);

}  // namespace raycone
