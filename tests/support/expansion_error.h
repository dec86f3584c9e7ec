// What an expansion is off by, term by term: the plain form of what SourceTree::least_cut() sums at once.
#pragma once

#include <cstddef>

#include "core/far/multipole.h"
#include "core/far/source_tree.h"

namespace raycone::test {

// Of `node`'s, cut off behind degree p, at a distance from its centre, at most; rounding may be left out.
inline double expansion_error(const SourceNode& node, int p, double distance) {
  const double rho = node.unit / distance;
  double power = rho;
  double sum = beyond_multipoles(node.area / node.unit / node.unit, node.radius / node.unit, node.bounds.order, rho);
  for (int n = 1; n <= node.bounds.order; ++n) {
    const auto i = static_cast<std::size_t>(n);
    power *= rho;
    sum += power * (n <= p ? node.bounds.evaluation[i] : node.bounds.size[i]);
  }
  return sum * (1 + 1e-12);
}

}  // namespace raycone::test
