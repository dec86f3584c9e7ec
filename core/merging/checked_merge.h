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

// How near points of a surface come to count as one with a corner of the input, or as in one plane: margins.
inline constexpr double kNearCorner = 16.0, kNearPlane = 2.5;

// How far that moves points of a surface at most, and points of the merged surface from it: to corners, and in planes
// that have what vanished on one side, as far as the corners of what is left are on the other. `margin` as a length;
// `tolerance`: of planes, as below.
[[nodiscard]] inline double most_merging(double margin, double tolerance) {
  return kNearCorner * margin + 2 * std::max(kNearPlane * margin, tolerance);
}

// How `simplify` is shared out, where that is not 0: a part is for merging, what is left is for pulls. World units.
struct SurfaceBounds {
  double margin = 0.0;     // how far points are kept off nodes
  double tolerance = 0.0;  // plane_tolerance()
  double simplify = 0.0;

  // How far apart numbers of one plane may be: where `simplify` is less, so that half of that is left.
  [[nodiscard]] double merge_tolerance() const {
    return simplify > 0.0 ? std::min(tolerance, simplify / 4) : tolerance;
  }
  // How far a point may be pulled, as merging has moved points already. Not positive where nothing is left.
  [[nodiscard]] double farthest_pull() const {
    constexpr double kRounding = 1.0 - 1e-6;
    return kRounding * simplify - most_merging(margin, merge_tolerance());
  }
};

struct CheckedMerge {
  std::optional<SurfaceMesh> surface;
  // With all merged, and points moved, nodes were on the wrong side: planes of the mesh lead through nodes, as nearly
  // as numbers can tell.
  bool cuts_nodes_off = false;
};

struct MergeOptions {
  double margin = 0.0;     // how far points are kept off nodes, voxels
  double tolerance = 0.0;  // how far apart numbers of one plane may be, world units (plane_tolerance())
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices, which stay so
  bool once = false;  // not again within less, as who calls can make another surface
};

// A surface merged by PlaneMerger, without what makes faults (faults_of()): vertices around them stay where they are,
// more of them the longer faults are left. So one place where planes do not agree costs few faces. Where that makes
// faults fewer, points are moved (move_points()). No surface where all that did not help. `input`: the mesh that it is
// of; `inside`: its nodes; `is_right`: whether the surface has no faults before, asked where that matters; none where
// it is known to have none, but perhaps nodes on the wrong side. The same for any number of threads.
[[nodiscard]] CheckedMerge checked_merge(const SurfaceMesh& surface, const TriangleMesh& input, const NodeSet& inside,
                                         const MergeOptions& options, const std::function<bool()>& is_right);

}  // namespace raycone
