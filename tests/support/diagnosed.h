// Winding numbers with all that an evaluation tells about them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "core/evaluation/winding_number.h"

namespace raycone::test {

struct Diagnosed {
  std::vector<double> values, bounds;
  std::vector<std::int64_t> crossings, degenerate;
  std::vector<std::uint8_t> on_surface;
  Tally tally{};

  explicit Diagnosed(std::size_t n) : values(n), bounds(n), crossings(n), degenerate(n), on_surface(n) {}

  [[nodiscard]] Diagnostics spans() { return {crossings, degenerate, on_surface, bounds}; }
  [[nodiscard]] auto all() const {
    return std::tie(values, bounds, crossings, degenerate, on_surface, tally.degenerate, tally.on_surface);
  }
  friend bool operator==(const Diagnosed& a, const Diagnosed& b) { return a.all() == b.all(); }
};

inline Diagnosed diagnosed(const WindingNumberEvaluator& evaluator, std::span<const Vec3> points) {
  Diagnosed result(points.size());
  const Diagnostics spans = result.spans();
  result.tally = evaluator.evaluate(points, result.values, nullptr, &spans);
  return result;
}

inline Diagnosed diagnosed(const WindingNumberEvaluator& evaluator, const Lattice& lattice, const LatticeBlock& block) {
  Diagnosed result(static_cast<std::size_t>(block.size()));
  const Diagnostics spans = result.spans();
  result.tally = evaluator.evaluate(lattice, block, result.values, nullptr, &spans);
  return result;
}

}  // namespace raycone::test
