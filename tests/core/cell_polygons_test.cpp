// Polygons in place of the triangles of tetrahedra: the same surface, in fewer faces.
#include "core/contour/cell_polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/plane_tolerance.h"
#include "core/certificate/certificate.h"
#include "core/contour/contour.h"
#include "core/contour/vertex_places.h"
#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "core/surface/surface.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;
using test::volume_of;

constexpr double kMargin = 0x1p-30;

Vec3 random_vector(Random& random) {
  return {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
}

Vec3 of_length_1(const Vec3& v) { return (1.0 / std::sqrt(dot(v, v))) * v; }

TriangleMesh turned(TriangleMesh mesh, Random& random) {
  const Vec3 u = of_length_1(random_vector(random)), v = of_length_1(cross(u, random_vector(random)));
  for (Vec3& p : mesh.vertices) p = p.x * u + p.y * v + p.z * cross(u, v);
  return mesh;
}

// What the steps before contour() make of a mesh.
struct Cells {
  TriangleMesh mesh;
  TriangleNormals normals;
  NodeSet nodes;
  SurfaceCells cells;
  CellTriangles triangles;
  CellCreases creases;
  std::vector<EdgePoint> points;
  FacePoints face_points;
  double tolerance;

  Cells(TriangleMesh of, const Lattice& lattice, PointsOfFaces kind = PointsOfFaces::kOne)
      : mesh(std::move(of)),
        normals(mesh),
        nodes(nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice)),
        cells(nodes),
        triangles(mesh, cells),
        creases(mesh, normals, triangles, cells),
        points(edge_points(mesh, {WindingNumberEvaluator(mesh), Rule{}}, cells, triangles, kMargin)),
        tolerance(plane_tolerance(mesh, lattice)) {
    face_points = FacePoints(in_cells(), kind);
  }

  [[nodiscard]] SurfaceInCells in_cells() const { return {cells, points, creases, tolerance, kMargin}; }
  [[nodiscard]] ContouredSurface contoured(ContourCells kind) const { return contour(in_cells(), face_points, kind); }
  [[nodiscard]] std::uint64_t misplaced(const ContouredSurface& of) const {
    const std::span apexes = std::span(of.surface.mesh.vertices).subspan(of.first_apex);
    return misplaced_vertices({points, face_points.positions(), apexes}, cells, face_points, of.tetrahedra, kMargin);
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

// Sides of polygons that two cells share are the same, and so are those that they share with tetrahedra.
TEST(CellPolygons, CloseUpToTheSameSolid) {
  const DefaultFloatingPoint guard;
  Random random(11);
  std::size_t with_apex = 0;
  for (int round = 0; round < 40; ++round) {
    const TriangleMesh shape = round % 2 == 0 ? test::octahedron() : test::box_mesh({0, 0, 0}, {1.0, 0.7, 0.4});
    const TriangleMesh mesh = turned(shape, random);
    const Cells cells(mesh, lattice_around(mesh, uniform(random, 0.04, 0.2)));
    const ContouredSurface whole = cells.contoured(ContourCells::kTetrahedra);
    const ContouredSurface fewer = cells.contoured(ContourCells::kPolygons);
    const TriangleMesh& used = fewer.surface.mesh;
    const SurfaceFaults faults = faults_of(used, cells.nodes);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
    EXPECT_EQ(cells.misplaced(fewer), 0U);
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
    const TriangleMesh mesh = turned(test::octahedron(), random);
    const double h = uniform(random, 0.05, 0.2);
    const Cells cells(mesh, lattice_around(mesh, h));
    const ContouredSurface whole = cells.contoured(ContourCells::kTetrahedra);
    const ContouredSurface fewer = cells.contoured(ContourCells::kPolygons);
    const double before = volume_of(whole.surface.mesh), after = volume_of(fewer.surface.mesh);
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
  int of_several = 0;
  for (int round = 0; round < 30; ++round) {
    TriangleMesh mesh = turned(large, random);
    const Lattice lattice = lattice_around(mesh, 2.0);
    const Cells cells(mesh, lattice);
    CreasesHere creases(cells.creases);
    CornerCells corners(cells.cells);
    CellPolygons polygons(cells.in_cells(), cells.face_points, creases, corners);
    for (std::uint32_t cell = 0; cell < cells.cells.cells().size(); ++cell) {
      std::vector<std::int32_t> sources;
      std::vector<Vec3> normals;
      for (unsigned low = 0; low < kuhn::kCorners; ++low) {
        for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
          const SurfaceCell& here = cells.cells.cells()[cell];
          if ((low & direction) != 0 || here.is_inside(low) == here.is_inside(low | direction)) continue;
          const std::uint32_t of_low = cells.cells.cell_at(cell, low);
          const EdgePoint& point = cells.points[cells.cells.cells()[of_low].edge(direction)];
          sources.push_back(point.source);
          normals.push_back(cells.creases.normal_of(point.source));
        }
      }
      // Each face of the box is two triangles.
      if (std::ranges::any_of(normals, [&](const Vec3& n) { return dot(n, normals.front()) < 0.9; })) continue;
      of_several += std::ranges::count(sources, sources.front()) != std::ssize(sources) ? 1 : 0;
      creases.enter(cell);
      corners.enter(cell);
      ASSERT_TRUE(polygons.find(cell));
      ASSERT_EQ(polygons.polygons().size(), 1U);
      EXPECT_NE(std::ranges::find(sources, polygons.polygons()[0].source), sources.end());
      EXPECT_LE(polygons.diagonals().size() + 3, polygons.polygons()[0].size);
      for (const DiagonalPoint& point : polygons.diagonals()) EXPECT_TRUE(point.is_inline);
    }
  }
  EXPECT_GT(of_several, 100);
}

// A box with its four edges along z cut off.
TriangleMesh chamfered_box(double cut) {
  return test::prism({{cut, 0}, {1 - cut, 0}, {1, cut}, {1, 1 - cut}, {1 - cut, 1}, {cut, 1}, {0, 1 - cut}, {0, cut}},
                     1.0);
}

// Of a surface, what is not in the planes of its sources.
std::ptrdiff_t faces_off_planes(const ContouredSurface& contoured, const TriangleMesh& mesh) {
  std::ptrdiff_t count = 0;
  for (std::size_t face = 0; face < contoured.surface.sources.size(); ++face) {
    const Triangle& source = mesh.triangles[static_cast<std::size_t>(contoured.surface.sources[face])];
    const Vec3& a = mesh.vertices[source[0]];
    const Vec3 normal = of_length_1(cross(mesh.vertices[source[1]] - a, mesh.vertices[source[2]] - a));
    count += std::ranges::any_of(contoured.surface.mesh.triangles[face], [&](std::uint32_t corner) {
      return std::abs(dot(normal, contoured.surface.mesh.vertices[corner] - a)) > 1e-8;
    });
  }
  return count;
}

// Strips of a third of a voxel pass most faces with both of their edges.
TEST(CellPolygons, FollowBothEdgesOfAStripThroughAFace) {
  const DefaultFloatingPoint guard;
  Random random(14);
  for (int round = 0; round < 10; ++round) {
    const double h = uniform(random, 0.04, 0.06);
    const TriangleMesh mesh = turned(chamfered_box(h / 4), random);
    const Cells one(mesh, lattice_around(mesh, h));
    Cells several(mesh, lattice_around(mesh, h), PointsOfFaces::kSections);
    EXPECT_GT(several.face_points.section_faces().size(), 10U);
    const std::vector<std::uint8_t> found = polygons_at_sections(several.in_cells(), several.face_points);
    several.face_points.keep_sections_at(found, several.in_cells());
    EXPECT_GT(several.face_points.section_faces().size(), 8U);
    const ContouredSurface before = one.contoured(ContourCells::kPolygons);
    const ContouredSurface after = several.contoured(ContourCells::kPolygons);
    const TriangleMesh& used = after.surface.mesh;
    const SurfaceFaults faults = faults_of(used, several.nodes);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
    EXPECT_LT(10 * faces_off_planes(after, mesh), 9 * faces_off_planes(before, mesh));
    EXPECT_LT(after.surface.sources.size(), before.surface.sources.size());
  }
}

// A side that is bent by 0.02 degrees is of two planes.
TEST(CellPolygons, AreInThePlanesBesideFineCreases) {
  const DefaultFloatingPoint guard;
  Random random(18);
  for (int round = 0; round < 6; ++round) {
    const TriangleMesh mesh = turned(test::prism({{0, 0}, {1, 0}, {1, 1}, {0.5, 1.00001}, {0, 1}}, 1.0), random);
    const Lattice lattice = lattice_around(mesh, uniform(random, 0.04, 0.06));
    const Cells one(mesh, lattice);
    const Cells several(mesh, lattice, PointsOfFaces::kSections);
    const ContouredSurface before = one.contoured(ContourCells::kPolygons);
    const ContouredSurface after = several.contoured(ContourCells::kPolygons);
    const TriangleMesh& used = after.surface.mesh;
    const SurfaceFaults faults = faults_of(used, several.nodes);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
    EXPECT_LT(faces_off_planes(after, mesh) + 20, faces_off_planes(before, mesh)) << round;
    EXPECT_LT(after.surface.sources.size() + 20, before.surface.sources.size()) << round;
  }
}

// A box whose top has small bumps, in triangles smaller than voxels.
TriangleMesh bumpy_box(Random& random) {
  constexpr std::uint32_t kSide = 30;
  TriangleMesh mesh;
  const auto number = [](std::uint32_t i, std::uint32_t j) { return i + (kSide + 1) * j; };
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    for (std::uint32_t i = 0; i <= kSide; ++i) {
      const bool at_border = i == 0 || j == 0 || i == kSide || j == kSide;
      mesh.vertices.push_back({i / double{kSide}, j / double{kSide}, at_border ? 0.0 : uniform(random, -1e-5, 1e-5)});
    }
  }
  const auto below = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& p : {Vec3{0, 0, -1}, Vec3{1, 0, -1}, Vec3{1, 1, -1}, Vec3{0, 1, -1}}) mesh.vertices.push_back(p);
  mesh.triangles = {{below, below + 2, below + 1}, {below, below + 3, below + 2}};
  for (std::uint32_t n = 0; n < kSide; ++n) {
    for (std::uint32_t m = 0; m < kSide; ++m) {
      mesh.triangles.push_back({number(n, m), number(n + 1, m), number(n + 1, m + 1)});
      mesh.triangles.push_back({number(n, m), number(n + 1, m + 1), number(n, m + 1)});
    }
    mesh.triangles.push_back({below, number(n + 1, 0), number(n, 0)});
    mesh.triangles.push_back({below + 1, number(kSide, n + 1), number(kSide, n)});
    mesh.triangles.push_back({below + 2, number(n, kSide), number(n + 1, kSide)});
    mesh.triangles.push_back({below + 3, number(0, n), number(0, n + 1)});
  }
  mesh.triangles.push_back({below, below + 1, number(kSide, 0)});
  mesh.triangles.push_back({below + 1, below + 2, number(kSide, kSide)});
  mesh.triangles.push_back({below + 2, below + 3, number(0, kSide)});
  mesh.triangles.push_back({below + 3, below, number(0, 0)});
  return mesh;
}

// Also where cells are cut into tetrahedra beside sections that follow fine creases.
TEST(CellPolygons, LeaveAllPointsOnTheMesh) {
  const DefaultFloatingPoint guard;
  Random random(19);
  for (int round = 0; round < 3; ++round) {
    const TriangleMesh mesh = turned(bumpy_box(random), random);
    const double h = uniform(random, 0.04, 0.06);
    const Cells cells(mesh, lattice_around(mesh, h), PointsOfFaces::kSections);
    const TriangleMesh used = cells.contoured(ContourCells::kPolygons).surface.mesh;
    const DistanceEvaluator from_mesh(mesh);
    std::vector<double> distances(used.vertices.size());
    from_mesh.evaluate(used.vertices, distances);
    EXPECT_LE(std::ranges::max(distances), 1e-8 * h) << round;
  }
}

// Without polygons nearby, faces have no more points than without sections.
TEST(CellPolygons, AreWhatSectionsAreFor) {
  const DefaultFloatingPoint guard;
  Random random(15);
  const TriangleMesh mesh = turned(chamfered_box(0.02), random);
  const Cells one(mesh, lattice_around(mesh, 0.08));
  Cells several(mesh, lattice_around(mesh, 0.08), PointsOfFaces::kSections);
  EXPECT_FALSE(several.face_points.section_faces().empty());
  const std::vector<std::uint8_t> none(several.cells.cells().size(), 0);
  several.face_points.keep_sections_at(none, several.in_cells());
  EXPECT_TRUE(several.face_points.section_faces().empty());
  std::vector<std::uint64_t> between;
  std::vector<Vec3> positions;
  for (std::size_t n = 0; n < one.face_points.faces().size(); ++n) {
    if (face_in_cell(one.face_points.faces()[n]) >= kuhn::kFacesBetweenCells) continue;
    between.push_back(one.face_points.faces()[n]);
    positions.push_back(one.face_points.positions()[n]);
  }
  EXPECT_EQ(several.face_points.faces(), between);
  EXPECT_EQ(several.face_points.positions(), positions);
}

// Whether cells are cut into tetrahedra or not, both sides of a face have its points in one order.
TEST(CellPolygons, CloseUpWhereFacesHaveSeveralPoints) {
  const DefaultFloatingPoint guard;
  Random random(16);
  for (int round = 0; round < 12; ++round) {
    const TriangleMesh mesh = turned(test::sphere(12), random);
    const Cells cells(mesh, lattice_around(mesh, uniform(random, 0.1, 0.25)), PointsOfFaces::kSections);
    EXPECT_GT(cells.face_points.section_faces().size(), 30U);
    for (const ContourCells kind : {ContourCells::kTetrahedra, ContourCells::kPolygons}) {
      const ContouredSurface made = cells.contoured(kind);
      const SurfaceFaults faults = faults_of(made.surface.mesh, cells.nodes);
      ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
      EXPECT_EQ(cells.misplaced(made), 0U);
    }
  }
}

// A round edge of pybullet's H0.STL: an odd number of points on a cell's faces is left where one plane is on both sides
// of the last of them.
TEST(CellPolygons, GoOnceAroundFromThePointOfAFace) {
  const DefaultFloatingPoint guard;
  const TriangleMesh mesh{{{0.02026059664785862, -0.062355704605579376, -0.023096155375242233},
                           {0.012285592965781689, -0.064403340220451355, -0.023096155375242233},
                           {0.012695024721324444, -0.066549643874168396, -0.008215378038585186},
                           {0.006935665849596262, -0.068102225661277771, -0.00299997185356915},
                           {0.012809316627681255, -0.067134104669094086, -0.00299997185356915},
                           {0.020935805514454842, -0.064433775842189789, -0.008215378038585186},
                           {0.015287379734218121, -0.066725656390190125, -0.00299997185356915},
                           {0.0042540379799902439, -0.067615993320941925, -0.008215378038585186},
                           {0.0176, -0.0863, -0.0109}},
                          {{0, 1, 2},
                           {3, 4, 2},
                           {5, 0, 2},
                           {5, 2, 6},
                           {6, 2, 4},
                           {3, 2, 7},
                           {7, 2, 1},
                           {1, 0, 8},
                           {4, 3, 8},
                           {0, 5, 8},
                           {5, 6, 8},
                           {6, 4, 8},
                           {3, 7, 8},
                           {7, 1, 8}}};
  const double h = 0.0011842161065011513;
  const Lattice lattice{
      {-0.013119620425025305, -0.0936463156671036, -0.0347366479086125}, {h, h, h}, {-1, -1, -1}, {47, 47, 47}};
  const Cells cells(mesh, lattice, PointsOfFaces::kSections);
  const SurfaceFaults faults = faults_of(cells.contoured(ContourCells::kPolygons).surface.mesh, cells.nodes);
  EXPECT_TRUE(faults.none()) << described(faults);
}

// A face keeps all of its points, or none.
TEST(FacePoints, AreDroppedFaceByFace) {
  const DefaultFloatingPoint guard;
  Random random(17);
  const TriangleMesh mesh = turned(test::sphere(12), random);
  const Cells cells(mesh, lattice_around(mesh, 0.2), PointsOfFaces::kSections);
  const FacePoints& all = cells.face_points;
  std::vector<bool> dropped(all.faces().size(), false);
  for (std::size_t n = 0; n < dropped.size(); n += 3) dropped[n] = true;
  const FacePoints left = all.without(dropped);
  for (std::size_t n = 0; n < all.faces().size(); ++n) {
    const std::uint32_t cell = cell_of_face(all.faces()[n]);
    const auto [first, count] = all.find(cell, face_in_cell(all.faces()[n]));
    bool is_dropped = false;
    for (std::uint32_t point = first; point < first + count; ++point) is_dropped = is_dropped || dropped[point];
    const auto [first_left, count_left] = left.find(cell, face_in_cell(all.faces()[n]));
    ASSERT_EQ(count_left, is_dropped ? 0U : count);
    for (std::uint32_t point = 0; point < count_left; ++point) {
      EXPECT_EQ(left.positions()[first_left + point], all.positions()[first + point]);
      if (point + 1 == count_left) continue;
      EXPECT_EQ(left.piece_behind(first_left + point).source, all.piece_behind(first + point).source);
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

// --simplify none writes the surface before faces are merged: its faces are more, its corners the same.
TEST(CellPolygons, AreThereWhereNothingIsMerged) {
  const TriangleMesh mesh = test::box_mesh({0.1, 0.1, 0.1}, {1.0, 0.9, 0.8});
  const Cells cells(mesh, lattice_around(mesh, 0.13));
  const WindingNumberEvaluator evaluator(mesh);
  const FinishedSurface made = closed_surface({mesh, evaluator, cells.nodes, {.rule = {}, .merge_planes = false}});
  const FinishedSurface merged = closed_surface({mesh, evaluator, cells.nodes, {.rule = {}}});
  EXPECT_LT(made.surface.sources.size(), cells.contoured(ContourCells::kTetrahedra).surface.sources.size());
  EXPECT_GT(made.surface.sources.size(), 10 * merged.surface.sources.size());
  for (const Vec3& corner : merged.surface.mesh.vertices) {
    double nearest = 1.0;
    for (const Vec3& v : made.surface.mesh.vertices) nearest = std::min(nearest, norm(v - corner));
    EXPECT_LT(nearest, 1e-8);  // margins, of which merging takes some
  }
}

}  // namespace
}  // namespace raycone
