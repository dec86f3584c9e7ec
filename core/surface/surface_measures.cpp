#include "core/surface/surface_measures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/distance/distance.h"
#include "core/mesh/components.h"

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
  std::vector<double> areas;
};

void add_samples(AreaSamples& samples, const TriangleMesh& mesh, const Triangle& t, double step) {
  constexpr double kMost = 64.0;
  const Vec3 &a = mesh.vertices[t[0]], u = mesh.vertices[t[1]] - a, v = mesh.vertices[t[2]] - a;
  const double longest = std::max({length_of_vector(u), length_of_vector(v), length_of_vector(v - u)});
  const double parts = std::clamp(std::ceil(longest / step), 1.0, kMost);
  const double area = area_of_triangle(mesh, t) / (parts * parts);
  const auto n = static_cast<int>(parts);
  const auto add = [&](double s, double r) {
    samples.points.push_back(a + (s / parts) * u + (r / parts) * v);
    samples.areas.push_back(area);
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      add(i + 1.0 / 3.0, j + 1.0 / 3.0);
      if (i + j + 1 < n) add(i + 2.0 / 3.0, j + 2.0 / 3.0);
    }
  }
}

double dropped_area_of(const SurfaceMesh& surface, const TriangleMesh& mesh, const Lattice& lattice, double thickness) {
  constexpr std::size_t kTrianglesAtOnce = 1024;
  const double diagonal = length_of_vector(lattice.spacing);
  const DistanceEvaluator distance(surface.mesh);
  double dropped = 0.0;
  for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += kTrianglesAtOnce) {
    AreaSamples samples;
    for (std::size_t i = begin; i < std::min(begin + kTrianglesAtOnce, mesh.triangles.size()); ++i) {
      add_samples(samples, mesh, mesh.triangles[i], 2.0 * diagonal);
    }
    std::vector<double> distances(samples.points.size());
    distance.evaluate(samples.points, distances);
    for (std::size_t i = 0; i < distances.size(); ++i)
      dropped += distances[i] > diagonal + thickness ? samples.areas[i] : 0.0;
  }
  return dropped;
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
  measures.dropped_area = dropped_area_of(surface, mesh, lattice, thickness);
  return measures;
}

}  // namespace raycone
