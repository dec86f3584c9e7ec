#include "core/boundary/boundary.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/boundary/enclosure.h"
#include "core/data/rule.h"
#include "core/exact/predicates.h"

namespace raycone {
namespace {

// The argument of an edge along the rays is 0 from everywhere, which the kernel would find out by predicates.
bool projects_to_a_point(const Vec3& a, const Vec3& b) { return a.y == b.y && a.z == b.z; }

// Whether w, which differs from `value` by at most 1/8 and from -(turns of the cone) by an integer, is above
// `critical` (1), below (-1), or indistinguishable from it (0); nothing where the bound is too large to tell.
std::optional<int> side_of(double critical, double value, const TurnsWithin& cone) {
  const auto n = static_cast<std::int64_t>(
      std::nearbyint(value + (static_cast<double>(cone.whole) + static_cast<double>(cone.rest))));
  const Quad w = static_cast<Quad>(n - cone.whole) - cone.rest;
  const Quad difference = w - critical;
  const Quad bound = cone.bound + 2 * kQuadRounding * (absolute(w) + absolute(difference));
  const bool is_close = bound <= kIndistinguishable;  // not so where the bound is NaN
  const Quad error = is_close ? kIndistinguishable : bound;
  if (difference > error) return 1;
  if (difference < -error) return -1;
  return is_close ? std::optional(0) : std::nullopt;
}

// `w` where it is there, else the number next to `critical`, or `critical`.
double on_side(int side, double critical, double w) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (side == 0) return critical;
  return side > 0 ? std::max(w, std::nextafter(critical, kInfinity))
                  : std::min(w, std::nextafter(critical, -kInfinity));
}

DirectedEdge directed(const Vec3& from, const Vec3& to, std::int32_t multiplicity) {
  return multiplicity < 0 ? DirectedEdge{to, from, -multiplicity} : DirectedEdge{from, to, multiplicity};
}

}  // namespace

Boundary::Boundary(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
  add_chains(mesh, edges);
  find_plane();
}

// The steps of edges along the rays are not joined.
void Boundary::add_chains(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges) {
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
    if (along_rays) edges_along_rays_.push_back(directed(from, to, e.multiplicity));
    steps.push_back({to, !along_rays, e.multiplicity < 0});
    total_multiplicity_ += multiplicity;
    previous = &e;
  }
}

std::vector<DirectedEdge> Boundary::directed_edges() const {
  std::vector<DirectedEdge> edges = edges_along_rays_;
  for (const ChainGroup& group : groups_) {
    for (std::size_t i = 1; i < group.steps.size(); ++i) {
      const ChainStep& step = group.steps[i];
      const std::int32_t multiplicity = step.reversed ? -group.multiplicity : group.multiplicity;
      if (step.joined) edges.push_back(directed(group.steps[i - 1].to, step.to, multiplicity));
    }
  }
  return edges;
}

// The plane through all exterior edges, if there is one and no more.
void Boundary::find_plane() {
  const Vec3 *a = nullptr, *b = nullptr, *c = nullptr;
  for (const ChainGroup& group : groups_) {
    for (const ChainStep& step : group.steps) {
      const Vec3& v = step.to;
      if (!a) {
        a = &v;
      } else if (!b) {
        if (v != *a) b = &v;
      } else if (!c) {
        if (!collinear(*a, *b, v)) c = &v;
      } else if (plane_side(*a, *b, *c, v) != 0) {
        return;
      }
    }
  }
  if (c) plane_ = {*a, *b, *c};
}

// In the plane of all exterior edges the cone over them with its apex in that plane is flat: it covers nothing, or half
// of all directions, of a query that is on none of the edges. w is then a multiple of 1/2.
bool Boundary::lies_in_plane_of_edges(const Vec3& q) const {
  if (!plane_ || plane_side((*plane_)[0], (*plane_)[1], (*plane_)[2], q) != 0) return false;
  for (const DirectedEdge& e : edges_along_rays_) {
    if (on_segment(e.from, e.to, q)) return false;
  }
  for (const ChainGroup& group : groups_) {
    for (std::size_t i = 1; i < group.steps.size(); ++i) {
      const ChainStep& step = group.steps[i];
      if (step.joined && on_segment(group.steps[i - 1].to, step.to, q)) return false;
    }
  }
  return true;
}

void Boundary::settle(const SampleTile& samples, std::span<const ToSettle> doubtful, std::span<double> w) const {
  std::array<ToSettle, kTile> others;
  SampleTile places;
  for (const auto& [i, critical] : doubtful) {
    const bool multiple_of_half = std::nearbyint(2 * critical) == 2 * critical;
    if (multiple_of_half && std::abs(w[i] - critical) < 0.25 && lies_in_plane_of_edges(samples.query(i))) {
      w[i] = critical;
    } else {
      others[places.count] = {i, critical};
      places.add(samples.query(i));
    }
  }
  if (places.count == 0) return;
  std::array<TurnsWithin, kTile> cones;
  enclose_in_106_bits(groups_, places, {cones.data(), places.count});
  for (std::size_t n = 0; n < places.count; ++n) {
    const auto& [i, critical] = others[n];
    std::optional<int> side = side_of(critical, w[i], cones[n]);
    if (!side) side = side_of(critical, w[i], enclose_in_113_bits(groups_, places.query(n)));
    w[i] = on_side(side.value_or(0), critical, w[i]);
  }
}

void Boundary::bound_errors(SampleTile& samples, std::span<const double> w, std::span<const std::int64_t> crossings,
                            std::span<double> bounds) const {
  // Turns per edge: w2 is known so well that whoever checks a bound in 64 bits, or in 113 next to an edge, would find
  // it violated by what the check rounds.
  constexpr double kForChecks = 0x1p-64;
  std::array<TurnsWithin, kTile> cones;
  enclose(groups_, samples, {cones.data(), samples.count});
  for (std::size_t i = 0; i < samples.count; ++i) {
    const Quad w2 = static_cast<Quad>(crossings[i] - cones[i].whole) - cones[i].rest;
    const Quad rounded = 4 * kQuadRounding * (std::abs(w[i]) + absolute(w2));
    const Quad bound = absolute(w[i] - w2) + cones[i].bound + rounded + kForChecks * total_multiplicity_;
    bounds[i] = std::nextafter(static_cast<double>(bound), std::numeric_limits<double>::infinity());
  }
}

}  // namespace raycone
