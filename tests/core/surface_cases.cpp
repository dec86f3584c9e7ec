#include "tests/core/surface_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "core/certificate/certificate.h"
#include "core/contour/vertex_places.h"
#include "core/distance/distance.h"
#include "core/mesh/used_part.h"
#include "tests/support/values.h"

namespace raycone::test {
namespace {

// Between 0 and 1. Often as near to an end as is allowed, where that is asked for.
double random_place(Random& random, bool to_margin) {
  const double extremes = to_margin ? uniform(random, 0.0, 4.0) : 4.0;
  if (extremes < 1.0) return kSurfaceMargin;
  if (extremes < 2.0) return 1.0 - kSurfaceMargin;
  return uniform(random, 0.01, 0.99);
}

}  // namespace

Lattice lattice_off_origin(std::int64_t side, double spacing) {
  return {{-0.3, 0.2, 0.1}, {spacing, spacing, spacing}, {-1, 2, 0}, {side, side, side}};
}

NodeSet nodes_where(const Lattice& lattice,
                    const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& inside) {
  NodeSet nodes(lattice);
  for (std::int64_t k = 1; k + 1 < lattice.counts[2]; ++k) {
    for (std::int64_t j = 1; j + 1 < lattice.counts[1]; ++j) {
      for (std::int64_t i = 1; i + 1 < lattice.counts[0]; ++i) {
        if (inside(i, j, k)) nodes.insert(i, j, k);
      }
    }
  }
  return nodes;
}

std::vector<EdgePoint> random_edge_points(const SurfaceCells& cells, Random& random, bool to_margin) {
  std::vector<EdgePoint> points(cells.edges());
  for (const SurfaceCell& cell : cells.cells()) {
    for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
      if ((cell.mixed_directions() >> direction & 1U) == 0) continue;
      const Vec3 low = cells.corner(cell, 0), high = cells.corner(cell, direction);
      points[cell.edge(direction)].position = low + random_place(random, to_margin) * (high - low);
    }
  }
  return points;
}

FacePoints random_face_points(const SurfaceCells& cells, Random& random) {
  std::vector<std::uint64_t> faces;
  std::vector<Vec3> positions;
  for (std::size_t n = 0; n < cells.cells().size(); ++n) {
    const SurfaceCell& cell = cells.cells()[n];
    for (std::size_t face = 0; face < kuhn::kFaces.size(); ++face) {
      const auto [first, second] = kuhn::kFaces[face];
      const bool mixed = cell.is_inside(0) != cell.is_inside(first) || cell.is_inside(0) != cell.is_inside(second);
      if (!mixed || uniform(random, 0.0, 1.0) < 0.5) continue;
      const double a = random_place(random, false), b = random_place(random, false), c = random_place(random, false);
      const double sum = a + b + c;
      const double u = a / sum, v = b / sum;
      const Vec3 low = cells.corner(cell, 0);
      faces.push_back(number_of_face(static_cast<std::uint32_t>(n), face));
      positions.push_back(low + u * (cells.corner(cell, first) - low) + v * (cells.corner(cell, second) - low));
    }
  }
  return {faces, positions};
}

std::uint64_t misplaced(std::span<const Vec3> vertices, const SurfaceCells& cells, const FacePoints& face_points,
                        std::span<const std::uint64_t> tetrahedra) {
  std::vector<EdgePoint> edges(cells.edges());
  for (std::size_t n = 0; n < edges.size(); ++n) edges[n].position = vertices[n];
  const std::span faces = vertices.subspan(edges.size(), face_points.faces().size());
  const std::span apexes = vertices.subspan(edges.size() + faces.size());
  return misplaced_vertices({edges, faces, apexes}, cells, face_points, tetrahedra, kSurfaceMargin);
}

TriangleMesh without_gone(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, is_gone);
  return mesh;
}

TriangleMesh compacted(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (Triangle t : triangles) {
    for (std::uint32_t& corner : t) {
      const auto [at, is_new] = numbers.try_emplace(corner, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(vertices[corner]);
      corner = at->second;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

TriangleMesh rotated(TriangleMesh mesh) {
  const Vec3 u{0.36, 0.48, -0.8}, v{-0.8, 0.6, 0.0}, w{0.48, 0.64, 0.6};
  for (Vec3& p : mesh.vertices) p = {dot(u, p), dot(v, p), dot(w, p)};
  return mesh;
}

Made surface_of(const TriangleMesh& mesh, std::int64_t side, const SurfaceOptions& options) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double h = std::max({size.x, size.y, size.z}) / static_cast<double>(side - 3);
  const Lattice lattice{box.lower, {h, h, h}, {-1, -1, -1}, {side + 1, side + 1, side + 1}};
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet nodes = nodes_inside(evaluator, options.rule, lattice);
  Made made{closed_surface({mesh, evaluator, nodes, options}).surface, lattice};
  EXPECT_TRUE(faults_of(made.surface.mesh, nodes).none());
  return made;
}

double largest_distance_of(const std::vector<Vec3>& points, const TriangleMesh& mesh) {
  const std::vector<double> distances = values_of(DistanceEvaluator(mesh), points);
  return *std::ranges::max_element(distances);
}

double volume_of(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c])) / 6.0;
  return volume;
}

TriangleMesh part_of_sphere(int rings, const std::function<bool(const Vec3&)>& has) {
  TriangleMesh mesh = test::sphere(rings);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return !has((1.0 / 3.0) * (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]));
  });
  return used_part(mesh.vertices, std::move(mesh.triangles));
}

TriangleMesh bitten_sphere(int rings, double height, double depth, double times, double at) {
  return part_of_sphere(
      rings, [&](const Vec3& p) { return p.z < height + depth * std::sin(times * std::atan2(p.y, p.x) + at); });
}

TriangleMesh cylinder() {
  constexpr int kSides = 24;
  std::vector<std::array<double, 2>> corners;
  for (int side = 0; side < kSides; ++side) {
    const double angle = 2.0 * std::numbers::pi * side / kSides;
    corners.push_back({std::cos(angle), std::sin(angle)});
  }
  return prism(corners, 1.3);
}

}  // namespace raycone::test
