#include "core/surface/surface_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/distance/distance.h"
#include "core/mesh/components.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/surface.h"

namespace raycone {
namespace {

double length_of_vector(const Vec3& v) { return std::hypot(v.x, v.y, v.z); }

double area_of_triangle(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return length_of_vector(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a)) / 2.0;
}

double largest_distance(const SurfaceMesh& surface, const TriangleMesh& mesh) {
  std::vector<bool> sourced(surface.mesh.vertices.size(), false);
  for (std::size_t i = 0; i < surface.mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : surface.mesh.triangles[i]) {
      sourced[corner] = sourced[corner] || surface.sources[i] != kHole;
    }
  }
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < sourced.size(); ++v) {
    if (sourced[v]) points.push_back(surface.mesh.vertices[v]);
  }
  std::vector<double> distances(points.size());
  if (!points.empty()) DistanceEvaluator(mesh).evaluate(points, distances);
  return distances.empty() ? 0.0 : *std::ranges::max_element(distances);
}

// The centres of n^2 equal parts of each triangle, and what area each of them stands for.
struct AreaSamples {
  std::vector<Vec3> points;
  std::vector<double> areas;  // in squares of sample_step()
  std::vector<std::uint32_t> triangles;
};

void add_samples(AreaSamples& samples, const TriangleMesh& mesh, std::uint32_t triangle, double step) {
  constexpr double kMost = 64.0;
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 &a = mesh.vertices[t[0]], u = mesh.vertices[t[1]] - a, v = mesh.vertices[t[2]] - a;
  const double longest = std::max({length_of_vector(u), length_of_vector(v), length_of_vector(v - u)});
  const double parts = std::clamp(std::ceil(longest / step), 1.0, kMost);
  const double area = length_of_vector(cross((1.0 / step) * u, (1.0 / step) * v)) / 2.0 / (parts * parts);
  const auto n = static_cast<int>(parts);
  const auto add = [&](double s, double r) {
    samples.points.push_back(a + (s / parts) * u + (r / parts) * v);
    samples.areas.push_back(area);
    samples.triangles.push_back(triangle);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      add(i + 1.0 / 3.0, j + 1.0 / 3.0);
      if (i + j + 1 < n) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
    }
  }
}

double sample_step(const Lattice& lattice) { return 2.0 * length_of_vector(lattice.spacing); }

// Calls visit(samples, is_dropped) for the points of some triangles at a time.
template <class Visit>
void for_samples(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice, double thickness,
                 const Visit& visit) {
  constexpr std::size_t kTrianglesAtOnce = 1024;
  const double diagonal = length_of_vector(lattice.spacing);
  const DistanceEvaluator distance(surface.mesh);
  for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += kTrianglesAtOnce) {
    AreaSamples samples;
    for (std::size_t i = begin; i < std::min(begin + kTrianglesAtOnce, mesh.triangles.size()); ++i) {
      add_samples(samples, mesh, static_cast<std::uint32_t>(i), sample_step(lattice));
    }
    std::vector<double> distances(samples.points.size());
    distance.evaluate(samples.points, distances);
    std::vector<bool> dropped;
    for (const double d : distances) dropped.push_back(d > diagonal + thickness);
    visit(samples, dropped);
  }
}

// Which points of triangles the lattice should have seen.
class MissedBy {
 public:
  MissedBy(const TriangleMesh& mesh, const RuleAlong& rule, const NodeSet& inside, double thickness)
      : mesh_(mesh), rule_(rule), inside_(inside), thickness_(thickness) {
    const Vec3& h = inside.lattice().spacing;
    step_ = surface_margin(inside.lattice(), false) * std::min({h.x, h.y, h.z});
  }

  [[nodiscard]] std::vector<bool> of(const AreaSamples& samples, const std::vector<bool>& dropped) const {
    std::vector<bool> missed(dropped.size(), false);
    std::vector<std::size_t> asked;
    std::vector<Vec3> sides;
    for (std::size_t n = 0; n < dropped.size(); ++n) {
      if (!dropped[n] || !(samples.areas[n] > 0.0)) continue;
      const Vec3& p = samples.points[n];
      const std::optional<bool> within = is_within(p);
      if (!within) continue;
      if (thickness_ > 0.0) {
        missed[n] = !*within;
        continue;
      }
      const Triangle& t = mesh_.triangles[samples.triangles[n]];
      const Vec3 normal = unit_normal(mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]);
      asked.push_back(n);
      sides.insert(sides.end(), {p - step_ * normal, p + step_ * normal});
    }
    const std::vector<double> values = rule_.at(sides);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      missed[asked[i]] = std::signbit(values[2 * i]) != std::signbit(values[2 * i + 1]);
    }
    return missed;
  }

 private:
  // Whether the nearest node is in the set; nothing outside of the lattice.
  [[nodiscard]] std::optional<bool> is_within(const Vec3& p) const {
    const Lattice& lattice = inside_.lattice();
    std::array<std::int64_t, 3> node;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double first = lattice.coordinate(axis, lattice.index_min[a]);
      const double index = std::round((p[axis] - first) / lattice.spacing[axis]);
      if (!(index >= 0.0 && index <= static_cast<double>(lattice.counts[a] - 1))) return std::nullopt;
      node[a] = static_cast<std::int64_t>(index);
    }
    return inside_.holds(node[0], node[1], node[2]);
  }

  const TriangleMesh& mesh_;
  const RuleAlong& rule_;
  const NodeSet& inside_;
  double thickness_, step_ = 0.0;
};

// In squares of sample_step().
double dropped_area_of(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice, double thickness) {
  double area = 0.0;
  for_samples(surface, mesh, lattice, thickness, [&](const AreaSamples& samples, const std::vector<bool>& dropped) {
    for (std::size_t n = 0; n < dropped.size(); ++n) area += dropped[n] ? samples.areas[n] : 0.0;
  });
  return area;
}

}  // namespace

SurfaceMeasures measure_surface(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice,
                                double thickness) {
  SurfaceMeasures measures;
  measures.components = components_of(surface.mesh).count;
  measures.max_distance = largest_distance(surface, mesh);
  for (std::size_t i = 0; i < surface.mesh.triangles.size(); ++i) {
    if (surface.sources[i] == kHole) measures.hole_area += area_of_triangle(surface.mesh, surface.mesh.triangles[i]);
  }
  const double step = sample_step(lattice), dropped = dropped_area_of(surface, mesh, lattice, thickness);
  measures.dropped_area = dropped * step * step;
  measures.drops = dropped > 0.0;
  return measures;
}

ThinParts thin_parts(const SurfaceMesh& surface, const TriangleMesh& mesh, const RuleAlong& rule, const NodeSet& inside,
                     double thickness) {
  const MissedBy missed_by(mesh, rule, inside, thickness);
  const Components components = components_of(mesh);
  std::vector<bool> is_left(components.count, false), is_missed(components.count, false);
  ThinParts thin;
  double whole = 0.0;
  const auto add = [&](const AreaSamples& samples, const std::vector<bool>& dropped) {
    const std::vector<bool> missed = missed_by.of(samples, dropped);
    for (std::size_t n = 0; n < dropped.size(); ++n) {
      const std::uint32_t component = components.of_vertex[mesh.triangles[samples.triangles[n]][0]];
      whole += samples.areas[n];
      thin.area += missed[n] ? samples.areas[n] : 0.0;
      if (missed[n]) is_missed[component] = true;
      if (!dropped[n]) is_left[component] = true;
    }
  };
  for_samples(surface, mesh, inside.lattice(), thickness, add);
  for (std::size_t c = 0; c < components.count; ++c) thin.lost += is_missed[c] && !is_left[c] ? 1 : 0;
  const double step = sample_step(inside.lattice());
  if (whole > 0.0) thin.of_all = thin.area / whole;
  thin.area *= step * step;
  return thin;
}

}  // namespace raycone
