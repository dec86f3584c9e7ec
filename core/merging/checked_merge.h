// Fewer triangles for the same surface, as far as that does no harm.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>

#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// How near a point of a surface has to be to count as a corner of the input, or as a point of a plane; in margins.
inline constexpr double kNearCorner = 16.0, kNearPlane = 2.5;

// How far merging moves points of a surface at most, and how far points of the merged surface are from it, world units:
// points move to corners, and where what vanished was off a plane on one side, the corners that are left may be as far
// off on the other. `margin`: as a length; `tolerance`: of planes, as below.
[[nodiscard]] inline double most_merging(double margin, double tolerance) {
  return kNearCorner * margin + 2 * std::max(kNearPlane * margin, tolerance);
}

// How `simplify` is shared out, where it is not 0: a part is for merging, the rest for pulls. All in world units.
struct SurfaceBounds {
  double margin = 0.0;     // how far points are kept off nodes
  double tolerance = 0.0;  // plane_tolerance()
  double simplify = 0.0;

  // How far apart numbers of one plane may be: less where `simplify` is small, so that half of it is left.
  [[nodiscard]] double merge_tolerance() const {
    return simplify > 0.0 ? std::min(tolerance, simplify / 4) : tolerance;
  }
  // How far a point may be pulled, beside what merging may have moved it. Not positive where nothing is left.
  [[nodiscard]] double farthest_pull() const {
    constexpr double kRounding = 1.0 - 1e-6;
    return kRounding * simplify - most_merging(margin, merge_tolerance());
  }
};

struct CheckedMerge {
  std::optional<SurfaceMesh> surface;
  // Nodes were on the wrong side even with points moved, and that costs many faces: planes of the mesh lead through
  // nodes, as nearly as numbers can tell.
  bool cuts_nodes_off = false;
};

struct MergeOptions {
  double margin = 0.0;     // how far points are kept off nodes, voxels
  double tolerance = 0.0;  // how far apart numbers of one plane may be, world units (plane_tolerance())
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices, which stay so
  bool once = false;  // do not try again within less: the caller can make another surface
};

// Merges a surface (PlaneMerger), without what makes faults (faults_of()): vertices around faults stay where they are,
// more of them the longer faults are left. So a place where planes do not agree costs few faces. Points are moved
// (move_points()) where that makes faults fewer. No surface where all that did not help. `input`: the mesh that the
// surface is of; `inside`: its nodes. `is_right`: asked, where that matters, whether the surface had no faults before;
// null: it is known to have none, but perhaps nodes on the wrong side. The same for any number of threads.
[[nodiscard]] CheckedMerge checked_merge(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside,
                                         const MergeOptions& options, const std::function<bool()>& is_right);

}  // namespace raycone
