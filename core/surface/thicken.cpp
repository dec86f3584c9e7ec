#include "core/surface/thicken.h"

#include <algorithm>
#include <cstdint>

#include "core/data/lattice_slabs.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Positive in the set, of the order of voxels and turns: the larger of what is left of the thickness, and the rule.
class ThickRule {
 public:
  ThickRule(const RuleAlong& rule, const DistanceEvaluator& distance, double thickness, double voxel)
      : rule_(rule), distance_(distance), thickness_(thickness), voxel_(voxel) {}

  [[nodiscard]] std::vector<double> at(const std::vector<Vec3>& points) const {
    std::vector<double> values(points.size());
    distance_.evaluate(points, values);
    std::vector<Vec3> beyond;
    for (std::size_t n = 0; n < points.size(); ++n) {
      values[n] = (thickness_ - values[n]) / voxel_;
      if (values[n] < 0.0) beyond.push_back(points[n]);
    }
    const std::vector<double> there = rule_.near(beyond);
    std::size_t next = 0;
    for (double& value : values) {
      if (value < 0.0) value = std::max(value, there[next++]);
    }
    return values;
  }

  // Whether it is the distance that ends the set near here.
  [[nodiscard]] std::vector<bool> at_thickness(const std::vector<Vec3>& points) const {
    constexpr double kNear = 1e-6;  // voxels: far above what rounding and roots leave
    std::vector<double> distances(points.size());
    distance_.evaluate(points, distances);
    std::vector<bool> near;
    for (const double d : distances) near.push_back(d <= thickness_ + kNear * voxel_);
    return near;
  }

 private:
  const RuleAlong& rule_;
  const DistanceEvaluator& distance_;
  double thickness_, voxel_;
};

// All mixed edges, from end to end.
std::vector<Bracket> mixed_edges(const SurfaceCells& cells) {
  std::vector<Bracket> edges;
  for (const SurfaceCell& cell : cells.cells()) {
    cells.for_each_edge(cell, [&](const MixedEdge& edge) { edges.push_back({edge, 0.0, 1.0}); });
  }
  return edges;
}

}  // namespace

void insert_near(NodeSet& nodes, const DistanceEvaluator& distance, double thickness) {
  constexpr std::int64_t kNodesAtOnce = std::int64_t{1} << 20;
  const Lattice& lattice = nodes.lattice();
  const double band = 2.0 * thickness;  // distances are cut off there
  std::vector<double> distances;
  for_each_slab(whole(lattice), kNodesAtOnce, [&](const LatticeBlock& slab) {
    const std::int64_t layer = slab.first[2] - lattice.index_min[2];
    distances.resize(static_cast<std::size_t>(slab.size()));
    distance.evaluate(lattice, slab, band, distances);
    for (std::int64_t n = 0; n < slab.size(); ++n) {
      if (distances[static_cast<std::size_t>(n)] > thickness) continue;
      const std::int64_t row = n / slab.counts[0];
      nodes.insert(n % slab.counts[0], row % slab.counts[1], layer + row / slab.counts[1]);
    }
  });
}

std::vector<EdgePoint> thick_edge_points(const RuleAlong& rule, const DistanceEvaluator& distance, double thickness,
                                         const SurfaceCells& cells, double margin) {
  const ThickRule thick(rule, distance, thickness, cells.lattice().least_spacing());
  std::vector<Bracket> brackets = mixed_edges(cells);
  find_roots(brackets, [&](const std::vector<Vec3>& places) { return thick.at(places); });
  std::vector<Vec3> places;
  for (const Bracket& bracket : brackets) {
    places.push_back(bracket.edge.point(std::clamp(bracket.root, margin, 1.0 - margin)));
  }
  const std::vector<bool> at_thickness = thick.at_thickness(places);
  std::vector<std::uint32_t> nearest(places.size());
  distance.find_nearest(places, nearest);
  std::vector<EdgePoint> points(cells.edges());
  for (std::size_t n = 0; n < places.size(); ++n) {
    points[brackets[n].edge.number] = {places[n], at_thickness[n] ? static_cast<std::int32_t>(nearest[n]) : kHole};
  }
  return points;
}

}  // namespace raycone
