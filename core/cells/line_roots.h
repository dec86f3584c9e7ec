// Where lines pass a threshold of a rule.
#pragma once

#include <optional>
#include <vector>

#include "core/cells/edge_roots.h"
#include "core/data/vec3.h"

namespace raycone {

// Points from `point` along a direction, as far as `reach`, world units.
struct Line {
  Vec3 point, direction;  // direction: of length 1; 0 for none
  double reach = 0.0;
  bool has_back = true;  // goes as far the other way, too
};

[[nodiscard]] Line line_through(const Vec3& point, const Vec3& direction, double reach);

// On each line the place, nearest to its point, where the rule changes. Looked at are the point, places `first` from it
// and twice as far again and again; the change is then found to 2^-34 of the way between two of these. Where it is at a
// triangle of the mesh, the place is `behind` that, inside; but no farther than half of the way to the next place
// inside. None where the rule changes nowhere, and of lines without a direction. Lengths are world units. The same for
// any number of threads.
[[nodiscard]] std::vector<std::optional<Vec3>> nearest_roots(const std::vector<Line>& lines, double first,
                                                             double behind, const RuleAlong& along);

}  // namespace raycone
