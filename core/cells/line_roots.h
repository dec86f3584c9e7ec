// Where lines pass a threshold of a rule.
#pragma once

#include <optional>
#include <vector>

#include "core/cells/edge_roots.h"
#include "core/data/vec3.h"

namespace raycone {

// From a point along a direction.
struct Line {
  Vec3 point, direction;  // of length 1; or 0, where there is none
  double reach = 0.0;
  bool has_back = true;  // goes as far the other way, too
};

[[nodiscard]] Line line_through(const Vec3& point, const Vec3& direction, double reach);

// The place on each line that is nearest to its point, of those where the rule changes between places that are looked
// at: the point, `first` from it, and twice as far again and again. To 2^-34 of the way between two of these. Where it
// changes at a triangle of the mesh, so far `behind` that, inside; or less, so that it is no farther than half of the
// way to such a place inside. None where it changes nowhere, and of lines without a direction. The same for any number
// of threads.
[[nodiscard]] std::vector<std::optional<Vec3>> nearest_roots(const std::vector<Line>& lines, double first,
                                                             double behind, const RuleAlong& along);

}  // namespace raycone
