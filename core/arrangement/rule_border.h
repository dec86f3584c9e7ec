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

// The parts of faces at which the rule holds on one side alone, facing the other one. All is exact, but that vertices
// are rounded in the end: points in which faces meet to the nearest doubles, and all to floats if those are asked for.
// Equal ones are one vertex then, and triangles of two equal corners are gone. So the border may pass through itself
// where points are about as close together as numbers are. None where the mesh is open, has more pairs than allowed, or
// takes too long, and where rays that are to tell its sides keep meeting edges. The same for any number of threads;
// uses those that ThreadLimit allows. Preconditions: `mesh` is welded, and its used vertices are below 2^1020. Needs
// DefaultFloatingPoint.
[[nodiscard]] std::optional<RuleBorder> rule_border(const TriangleMesh& mesh, const RuleBorderOptions& options);

}  // namespace raycone
