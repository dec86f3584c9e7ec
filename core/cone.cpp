#include "core/cone.h"

#include <algorithm>
#include <cstdlib>

#include "core/exterior_edges.h"

namespace raycone {
namespace {

// The argument of an edge along the rays is 0 from everywhere, which the kernel would find out by predicates.
bool projects_to_a_point(const Vec3& a, const Vec3& b) { return a.y == b.y && a.z == b.z; }

}  // namespace

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
    const bool has_argument = !projects_to_a_point(mesh.vertices[e.from], mesh.vertices[e.to]);
    steps.push_back({mesh.vertices[e.to], has_argument, e.multiplicity < 0});
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
