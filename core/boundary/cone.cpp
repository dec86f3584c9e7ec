#include "core/boundary/cone.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/mesh/exterior_edges.h"

namespace raycone {
namespace {

// The argument of an edge along the rays is 0 from everywhere, which the kernel would find out by predicates.
bool projects_to_a_point(const Vec3& a, const Vec3& b) { return a.y == b.y && a.z == b.z; }

// A product's argument may be off by 1e-13 in double. Times more than this it would show; edges that so many faces
// share are rare enough for 64 bits.
constexpr std::int32_t kLargestInDouble = 256;

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
    const Vec3 &from = mesh.vertices[e.from], &to = mesh.vertices[e.to];
    const bool along_rays = projects_to_a_point(from, to);
    if (along_rays) edges_along_rays_.push_back({from, to});
    steps.push_back({to, !along_rays, e.multiplicity < 0});
    total_multiplicity_ += multiplicity;
    previous = &e;
  }
  find_plane();
}

void Cone::add_enclosed(const Group& group, const SampleTile& samples, std::span<Turns> cone) {
  for (std::size_t i = 0; i < samples.count; ++i) {
    const TurnsWithin<long double> turns = enclose(group, {samples.x[i], samples.y[i], samples.z[i]});
    const long double rest = group.multiplicity * turns.rest, whole = std::nearbyint(rest);
    cone[i].whole += group.multiplicity * turns.whole + static_cast<std::int64_t>(whole);
    cone[i].rest += static_cast<double>(rest - whole);
  }
}

void Cone::winding_numbers(SampleTile& samples, std::span<Turns> cone) const {
  samples.fill_up();
  std::fill(cone.begin(), cone.end(), Turns{});
  ProductTile products;
  for (const Group& group : groups_) {
    if (group.multiplicity > kLargestInDouble) {
      add_enclosed(group, samples, cone);
      continue;
    }
    multiply_chains_(group.steps, samples, products);
    for (std::size_t i = 0; i < samples.count; ++i) {
      cone[i].whole += group.multiplicity * static_cast<std::int64_t>(products.turns[i]);
      cone[i].rest += group.multiplicity * products.argument[i];
    }
  }
}

}  // namespace raycone
