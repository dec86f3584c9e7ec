// What evaluators find, as vectors.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/evaluation/winding_number.h"

namespace raycone::test {

// Winding numbers or distances at points, in their order.
template <class Evaluator>
[[nodiscard]] std::vector<double> values_of(const Evaluator& evaluator, std::span<const Vec3> points) {
  std::vector<double> values(points.size());
  evaluator.evaluate(points, values);
  return values;
}

// Winding numbers at the samples of a block, x fastest.
[[nodiscard]] inline std::vector<double> values_of(const WindingNumberEvaluator& evaluator, const Lattice& lattice,
                                                   const LatticeBlock& block) {
  std::vector<double> values(static_cast<std::size_t>(block.size()));
  evaluator.evaluate(lattice, block, values);
  return values;
}

// At all samples.
[[nodiscard]] inline std::vector<double> values_of(const WindingNumberEvaluator& evaluator, const Lattice& lattice) {
  return values_of(evaluator, lattice, whole(lattice));
}

}  // namespace raycone::test
