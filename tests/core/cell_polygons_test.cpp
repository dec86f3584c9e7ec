// Polygons in place of the triangles of tetrahedra: the same surface, in fewer faces.
#include "core/surface/cell_polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "core/mesh/mesh_statistics.h"
#include "core/surface/certificate.h"
#include "core/surface/contour.h"
#include "core/surface/surface.h"
#include "core/surface/vertex_places.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

constexpr SurfaceMargins kMargins;

Vec3 random_vector(Random& random) {
  return {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
}

Vec3 of_length_1(const Vec3& v) { return (1.0 / std::sqrt(dot(v, v))) * v; }

TriangleMesh turned(TriangleMesh mesh, Random& random) {
  const Vec3 u = of_length_1(random_vector(random)), v = of_length_1(cross(u, random_vector(random)));
  for (Vec3& p : mesh.vertices) p = p.x * u + p.y * v + p.z * cross(u, v);
  return mesh;
}

TriangleMesh octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

// What the steps before contour() make of a mesh.
struct Cells {
  TriangleMesh mesh;
  NodeSet nodes;
  SurfaceCells cells;
  CellTriangles triangles;
  CellCreases creases;
  std::vector<EdgePoint> points;
  FacePoints face_points;
  double tolerance;

  Cells(TriangleMesh of, const Lattice& lattice)
      : mesh(std::move(of)),
        nodes(nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice)),
        cells(nodes),
        triangles(mesh, cells),
        creases(mesh, triangles),
        points(edge_points(mesh, WindingNumberEvaluator(mesh), Rule{}, cells, triangles, kMargins)),
        tolerance(plane_tolerance(mesh, lattice)) {
    face_points = FacePoints(cells, points, creases, tolerance, kMargins);
  }

  [[nodiscard]] ContouredSurface contoured(ContourCells kind) const {
    return contour(cells, points, face_points, creases, tolerance, kMargins, kind);
  }
};

Lattice lattice_around(const TriangleMesh& mesh, double h) {
  const Box box = bounding_box(mesh);
  Lattice lattice{box.lower, {h, h, h}, {-2, -2, -2}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.counts[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>((box.upper[axis] - box.lower[axis]) / h) + 6;
  }
  return lattice;
}

// Without the vertices that no face has.
TriangleMesh used_mesh(const ContouredSurface& contoured) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> number;
  for (std::size_t v = 0; v < contoured.spare.size(); ++v) {
    number.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    if (contoured.spare[v] == 0) mesh.vertices.push_back(contoured.surface.mesh.vertices[v]);
  }
  for (const Triangle& t : contoured.surface.mesh.triangles) {
    for (const std::uint32_t corner : t) EXPECT_EQ(contoured.spare[corner], 0);
    mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return mesh;
}

// The area of the faces of each source.
std::vector<double> areas(const SurfaceMesh& surface, std::size_t sources) {
  std::vector<double> result(sources, 0.0);
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle& t = surface.mesh.triangles[face];
    const Vec3& a = surface.mesh.vertices[t[0]];
    const Vec3 normal = cross(surface.mesh.vertices[t[1]] - a, surface.mesh.vertices[t[2]] - a);
    result[static_cast<std::size_t>(surface.sources[face])] += std::sqrt(dot(normal, normal)) / 2;
  }
  return result;
}

double volume_of(const TriangleMesh& mesh) { return mesh_statistics(mesh).signed_volume.value_or(0.0); }

// Sides of polygons that two cells share are the same, and so are those that they share with tetrahedra.
TEST(CellPolygons, CloseUpToTheSameSolid) {
  const DefaultFloatingPoint guard;
  Random random(11);
  std::size_t with_apex = 0;
  for (int round = 0; round < 40; ++round) {
    const TriangleMesh shape = round % 2 == 0 ? octahedron() : test::box_mesh({0, 0, 0}, {1.0, 0.7, 0.4});
    const TriangleMesh mesh = turned(shape, random);
    const Cells cells(mesh, lattice_around(mesh, uniform(random, 0.04, 0.2)));
    const ContouredSurface whole = cells.contoured(ContourCells::kTetrahedra);
    const ContouredSurface fewer = cells.contoured(ContourCells::kPolygons);
    const TriangleMesh used = used_mesh(fewer);
    const SurfaceFaults faults = faults_of(used, cells.nodes);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
    EXPECT_EQ(
        misplaced_vertices(fewer.surface.mesh.vertices, cells.cells, cells.face_points, fewer.tetrahedra, kMargins),
        0U);
    EXPECT_EQ(fewer.surface.sources.size() + fewer.fewer, whole.surface.sources.size()) << round;
    EXPECT_LT(8 * used.triangles.size(), 7 * whole.surface.mesh.triangles.size());
    with_apex += static_cast<std::size_t>(
        std::ranges::count_if(fewer.tetrahedra, [](std::uint64_t place) { return (place & kWholeCell) != 0; }));
  }
  EXPECT_GT(with_apex, 20U);
}

// Away from sharp edges that the lattice does not see, both are the mesh's own.
TEST(CellPolygons, HaveThePlanesOfTheirSources) {
  const DefaultFloatingPoint guard;
  Random random(12);
  for (int round = 0; round < 10; ++round) {
    const TriangleMesh mesh = turned(octahedron(), random);
    const double h = uniform(random, 0.05, 0.2);
    const Cells cells(mesh, lattice_around(mesh, h));
    const ContouredSurface whole = cells.contoured(ContourCells::kTetrahedra);
    const ContouredSurface fewer = cells.contoured(ContourCells::kPolygons);
    const double before = volume_of(whole.surface.mesh), after = volume_of(used_mesh(fewer));
    // Along a side of length 4.2 in all, tetrahedra leave a strip that is a part of a voxel wide. Polygons go on to
    // where planes meet, beyond what a tetrahedron cuts off.
    EXPECT_GE(after, before - 1e-9);
    EXPECT_LE(after, volume_of(mesh) + 1e-9);
    const std::vector<double> of_whole = areas(whole.surface, 8), of_fewer = areas(fewer.surface, 8);
    for (std::size_t source = 0; source < 8; ++source) EXPECT_NEAR(of_fewer[source], of_whole[source], 0.3 * h);
  }
}

// A plane through a cell at any place: each way in which it parts the nodes.
TEST(CellPolygons, AreFoundHoweverAPlanePartsACell) {
  const DefaultFloatingPoint guard;
  Random random(13);
  const TriangleMesh large = test::box_mesh({-9, -9, -9}, {9, 9, 0});
  for (int round = 0; round < 30; ++round) {
    TriangleMesh mesh = turned(large, random);
    const Lattice lattice = lattice_around(mesh, 2.0);
    const Cells cells(mesh, lattice);
    CreasesHere creases(cells.creases);
    CornerCells corners(cells.cells);
    CellPolygons polygons(cells.cells, cells.points, cells.face_points, creases, corners, 0x1p-30 * 2.0);
    for (std::uint32_t cell = 0; cell < cells.cells.cells().size(); ++cell) {
      std::vector<std::int32_t> sources;
      for (unsigned low = 0; low < kuhn::kCorners; ++low) {
        for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
          const SurfaceCell& here = cells.cells.cells()[cell];
          if ((low & direction) != 0 || here.is_inside(low) == here.is_inside(low | direction)) continue;
          sources.push_back(cells.points[cells.cells.cells()[cells.cells.cell_at(cell, low)].edge(direction)].source);
        }
      }
      if (std::ranges::count(sources, sources.front()) != std::ssize(sources)) continue;
      creases.enter(cell);
      corners.enter(cell);
      ASSERT_TRUE(polygons.find(cell));
      ASSERT_EQ(polygons.polygons().size(), 1U);
      EXPECT_EQ(polygons.polygons()[0].source, sources.front());
      EXPECT_LE(polygons.diagonals().size() + 3, polygons.polygons()[0].size);
      for (const DiagonalPoint& point : polygons.diagonals()) EXPECT_TRUE(point.is_inline);
    }
  }
}

// With corners on its sides, a polygon has no faces without area.
TEST(CellPolygons, AreCutIntoTrianglesWithAnArea) {
  const std::vector<Vec3> triangle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 2, 0}, {0, 1, 0}};
  const std::size_t from = best_fan(triangle);
  for (std::size_t n = 1; n + 1 < triangle.size(); ++n) {
    const Vec3 &a = triangle[from], &b = triangle[(from + n) % 6], &c = triangle[(from + n + 1) % 6];
    EXPECT_GT(cross(b - a, c - a).z, 0.1);
  }
}

// --simplify none writes the triangles of all tetrahedra.
TEST(CellPolygons, AreNotUsedWhereNothingIsMerged) {
  const TriangleMesh mesh = test::box_mesh({0.1, 0.1, 0.1}, {1.0, 0.9, 0.8});
  const Cells cells(mesh, lattice_around(mesh, 0.13));
  const WindingNumberEvaluator evaluator(mesh);
  const FinishedSurface made = closed_surface(mesh, evaluator, cells.nodes, {.rule = {}, .merge_planes = false});
  const ContouredSurface whole = cells.contoured(ContourCells::kTetrahedra);
  EXPECT_GE(made.surface.sources.size() + 200, whole.surface.sources.size());
  EXPECT_GT(3 * made.surface.sources.size(), 4 * cells.contoured(ContourCells::kPolygons).surface.sources.size());
}

}  // namespace
}  // namespace raycone
