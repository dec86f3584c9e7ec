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

// Those of `reversed`, `inconsistent`, `opposite-duplicates`, in this order, that apply. `orient`: how the mesh was
// turned.
[[nodiscard]] std::vector<Warning> warnings_about(const MeshDefects& defects, Orient orient);

// The number of triangles with corners at three different positions. What a weld takes from that has collapsed.
[[nodiscard]] std::uint64_t triangles_with_corners(const TriangleMesh& mesh);

// `weld-collapsed`: `faces` (not 0) lost their area to `distance`.
[[nodiscard]] Warning weld_collapsed(std::uint64_t faces, double distance);

// Those of `unorientable`, `walls`, in this order, that apply to meshes with these counts; of several meshes, added up.
[[nodiscard]] std::vector<Warning> warnings_about(const OrientationCounts& counts);

// Whether a mesh in `box` has a volume to be found: the box is not flat.
[[nodiscard]] bool may_have_inside(const Box& box);

// Whether it is worth a warning if no sample of `lattice` is inside the mesh in `box`: may_have_inside(box), and the
// lattice reaches around the box, but for a voxel.
[[nodiscard]] bool should_have_inside(const Box& box, const PlacedLattice& lattice);

// `tolerance`: values are only promised within `bound`, which is more. A bound of 0 (closed meshes) keeps any promise,
// and a tolerance that counts as 0 asks for none.
[[nodiscard]] std::optional<Warning> tolerance_not_kept(double tolerance, double bound);

// `empty`, of a mesh in `box`. `orient`: how the mesh was turned.
[[nodiscard]] Warning nothing_inside(const Rule& rule, Orient orient, const Box& box, const PlacedLattice& lattice);

// `empty`, of a mesh where points are drawn in its box or near its surface. `orient`: how the mesh was turned.
[[nodiscard]] Warning no_point_inside(const Rule& rule, Orient orient);

}  // namespace raycone
