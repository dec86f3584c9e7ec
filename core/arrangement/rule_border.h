// Where a closed mesh has the border of the set that a rule makes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/coordinate_precision.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

struct RuleBorder {
  TriangleMesh mesh;                   // without vertices that no triangle uses
  std::vector<std::uint32_t> sources;  // of each triangle: the triangle of the input that it is part of
};

struct RuleBorderOptions {
  Rule rule;
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices
  std::size_t most_pairs = 0;                                    // of faces that meet beyond what they share
};

// The border of the set where the rule holds: the parts of faces with the rule holding on one side alone, turned to
// face the other side. All is exact but the last step, which rounds vertices: points in which faces meet to the nearest
// doubles, then all to floats where `options.precision` says so. Vertices that are equal then become one, and triangles
// with two equal corners go. So the border may pass through itself where points are about as close together as numbers
// are.
// None where the mesh is open, has more than `most_pairs` such pairs, or takes too long, and where the rays that are to
// tell its sides keep meeting edges. Uses the threads that ThreadLimit allows; the same for any number of them.
// Preconditions: `mesh` is welded, and its used vertices are below 2^1020 in magnitude. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<RuleBorder> rule_border(const TriangleMesh& mesh, const RuleBorderOptions& options);

}  // namespace raycone
