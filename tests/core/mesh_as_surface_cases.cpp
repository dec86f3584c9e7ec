#include "tests/core/mesh_as_surface_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "core/certificate/certificate.h"
#include "core/data/box.h"
#include "core/data/coordinate_precision.h"
#include "core/evaluation/winding_number.h"
#include "core/filling/mesh_as_surface.h"
#include "tests/support/shapes.h"

namespace raycone::test {

TriangleMesh turned(TriangleMesh mesh) {
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(1.1), e = std::sin(1.1);
  for (Vec3& v : mesh.vertices) {
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    v = {v.x, d * v.y - e * v.z, e * v.y + d * v.z};
  }
  return mesh;
}

Lattice lattice_around(const TriangleMesh& mesh, double side) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double h = std::max({size.x, size.y, size.z}) / side;
  Lattice lattice{box.lower - Vec3{h / 2, h / 2, h / 2}, {h, h, h}, {-1, -1, -1}, {}};
  for (int axis = 0; axis < 3; ++axis)
    lattice.counts[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::ceil(size[axis] / h)) + 5;
  return lattice;
}

NodeSet nodes_of(const TriangleMesh& mesh, double side, const Rule& rule) {
  return nodes_inside(WindingNumberEvaluator(mesh), rule, lattice_around(mesh, side));
}

std::optional<FinishedSurface> kept(const TriangleMesh& mesh, double side, const SurfaceOptions& options) {
  const NodeSet inside = nodes_of(mesh, side, options.rule);
  EXPECT_FALSE(inside.empty());
  EXPECT_FALSE(inside.reaches_border());
  const WindingNumberEvaluator evaluator(mesh);
  std::optional<FinishedSurface> made = mesh_as_surface({mesh, evaluator, inside, options});
  if (made) {
    EXPECT_TRUE(faults_of(made->surface.mesh, inside).none());
    std::vector<Vec3> rounded = made->surface.mesh.vertices;
    round_to(CoordinatePrecision::kSingle, rounded);
    EXPECT_TRUE(options.precision == CoordinatePrecision::kDouble || rounded == made->surface.mesh.vertices);
    EXPECT_EQ(made->surface.sources.size(), made->surface.mesh.triangles.size());
  }
  return made;
}

bool holds_all(const FinishedSurface& made) {
  return made.own && !made.own->held.empty() &&
         std::ranges::all_of(made.own->held, [](bool is_held) { return is_held; });
}

std::vector<Vec3> sorted_vertices(const TriangleMesh& mesh) {
  std::vector<Vec3> vertices = mesh.vertices;
  std::ranges::sort(vertices, {}, [](const Vec3& v) { return std::tuple(v.x, v.y, v.z); });
  return vertices;
}

TriangleMesh box_at(double x, double size) { return box_mesh({x, 0.3, 0.4}, {x + size, 0.3 + size, 0.4 + size}); }

TriangleMesh finned(double thickness, double length) {
  return prism({{0.0, 0.0}, {1.0 + length, 0.0}, {1.0 + length, thickness}, {1.0, thickness}, {1.0, 1.0}, {0.0, 1.0}},
               1.0);
}

}  // namespace raycone::test
