#include "core/cone.h"

#include <algorithm>
#include <cstdlib>

#include "core/exterior_edges.h"

namespace raycone {

Cone::Cone(const TriangleMesh& mesh, SimdLevel level) : multiply_chains_(cone_kernel(level)) {
  const std::vector<ExteriorEdge> edges = raycone::exterior_edges(mesh);
  edges_ = edges.size();
  const ExteriorEdge* previous = nullptr;
  for (const ExteriorEdge& e : edges) {
    const std::int32_t multiplicity = std::abs(e.multiplicity);
    if (groups_.empty() || groups_.back().multiplicity != multiplicity) {
      groups_.push_back({multiplicity, {}});
      previous = nullptr;
    }
    std::vector<ChainStep>& steps = groups_.back().steps;
    if (!previous || previous->to != e.from) steps.push_back({mesh.vertices[e.from], false, false});
    steps.push_back({mesh.vertices[e.to], true, e.multiplicity < 0});
    previous = &e;
  }
}

void Cone::winding_numbers(SampleTile& samples, std::span<Turns> cone) const {
  samples.fill_up();
  std::fill(cone.begin(), cone.end(), Turns{});
  ProductTile products;
  for (const Group& group : groups_) {
    multiply_chains_(group.steps, samples, products);
    for (std::size_t i = 0; i < samples.count; ++i) {
      cone[i].whole += group.multiplicity * static_cast<std::int64_t>(products.turns[i]);
      cone[i].rest += group.multiplicity * products.argument[i];
    }
  }
}

}  // namespace raycone
