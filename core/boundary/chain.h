// Exterior edges as kernels and enclosures walk along them: in chains, so that each vertex is looked at once.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

struct ChainStep {
  Vec3 to;
  bool joined;    // the edge from the previous step's vertex to this one is there; else a chain begins here
  bool reversed;  // its multiplicity is negative
};

// Chains of edges of one |multiplicity|: the product of their factors is common.
struct ChainGroup {
  std::int32_t multiplicity = 1;  // positive
  std::vector<ChainStep> steps;
};

}  // namespace raycone
