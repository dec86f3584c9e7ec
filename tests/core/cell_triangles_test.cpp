#include "core/cells/cell_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/cells/surface_cells.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

constexpr std::int64_t kSideOfCells = 12;  // nodes
constexpr Lattice kLattice{{-3.25, 0.5, 7.0}, {0.5, 0.25, 1.0}, {2, -3, 5}, {kSideOfCells, kSideOfCells, kSideOfCells}};

// Most cells have nodes of both kinds.
SurfaceCells many_cells() {
  NodeSet nodes(kLattice);
  for (std::int64_t k = 1; k + 1 < kSideOfCells; ++k) {
    for (std::int64_t j = 1; j + 1 < kSideOfCells; ++j) {
      for (std::int64_t i = 1; i + 1 < kSideOfCells; ++i) {
        if ((i + j + k) % 3 == 0) nodes.insert(i, j, k);
      }
    }
  }
  return SurfaceCells(nodes);
}

// Whether a triangle meets a cube around the origin, by the thirteen axes that may separate them (Akenine-Möller 2001).
bool meets_cube(const std::array<Vec3, 3>& t, double half) {
  const std::array<Vec3, 3> units{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const auto separates = [&](const Vec3& axis) {
    const auto [low, high] = std::minmax({dot(t[0], axis), dot(t[1], axis), dot(t[2], axis)});
    const double reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return low > reach || high < -reach;
  };
  if (separates(cross(t[1] - t[0], t[2] - t[0]))) return false;
  return std::ranges::none_of(units, [&](const Vec3& unit) {
    return separates(unit) || separates(cross(unit, t[1] - t[0])) || separates(cross(unit, t[2] - t[1])) ||
           separates(cross(unit, t[0] - t[2]));
  });
}

bool meets_cell(const TriangleMesh& mesh, std::size_t triangle, const SurfaceCells& cells, std::uint32_t cell,
                double half) {
  const Vec3 low = cells.position(cells.cells()[cell].node);
  const Vec3& h = kLattice.spacing;
  std::array<Vec3, 3> t;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 v = mesh.vertices[mesh.triangles[triangle][n]] - low;
    t[n] = Vec3{v.x / h.x, v.y / h.y, v.z / h.z} - Vec3{0.5, 0.5, 0.5};
  }
  return meets_cube(t, half);
}

// Those that come into cells, and none that is far from them.
void expect_triangles_of_cells(const TriangleMesh& mesh) {
  constexpr double kNear = 0x1p-5;  // twice the margin
  const SurfaceCells cells = many_cells();
  const CellTriangles found(mesh, cells);
  std::size_t meetings = 0;
  for (std::uint32_t cell = 0; cell < cells.cells().size(); ++cell) {
    const auto of_cell = found.of(cell);
    EXPECT_TRUE(std::ranges::is_sorted(of_cell));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool is_found = std::ranges::binary_search(of_cell, static_cast<std::uint32_t>(t));
      if (meets_cell(mesh, t, cells, cell, 0.5)) {
        ++meetings;
        ASSERT_TRUE(is_found) << "triangle " << t << ", cell " << cell;
      } else if (is_found) {
        ASSERT_TRUE(meets_cell(mesh, t, cells, cell, 0.5 + kNear)) << "triangle " << t << ", cell " << cell;
      }
    }
  }
  EXPECT_GT(meetings, mesh.triangles.size());
}

Vec3 point_near(Random& random, double beyond) {
  const auto at = [&](int axis) {
    const double low = kLattice.coordinate(axis, kLattice.index_min[static_cast<std::size_t>(axis)]);
    const double size = kLattice.coordinate(axis, kLattice.index_max(axis)) - low;
    return low + size * uniform(random, -beyond, 1.0 + beyond);
  };
  return {at(0), at(1), at(2)};
}

TEST(CellTriangles, AreThoseThatComeIntoTheCell) {
  Random random(3);
  TriangleMesh mesh;
  for (const double beyond : {0.0, 0.5, 100.0}) {
    for (std::uint32_t n = 0; n < 60; ++n) {
      const Vec3 a = point_near(random, beyond), b = point_near(random, beyond);
      // Small ones, needles, large ones.
      const Vec3 c = n % 3 == 0   ? b + 0x1p-9 * (b - a)
                     : n % 3 == 1 ? a + 0.02 * (point_near(random, 1) - a)
                                  : point_near(random, beyond);
      test::add_triangle(mesh, a, n % 3 == 1 ? a + 0.02 * (b - a) : b, c);
    }
  }
  expect_triangles_of_cells(mesh);
}

// In the planes of nodes, along their edges, and points.
TEST(CellTriangles, MayBeInPlanesOfNodes) {
  Random random(4);
  TriangleMesh mesh;
  const auto node = [&] {
    const auto at = [&](int axis) {
      const auto n = static_cast<std::int64_t>(uniform(random, 0.0, static_cast<double>(kSideOfCells)));
      return kLattice.coordinate(axis, kLattice.index_min[static_cast<std::size_t>(axis)] + n);
    };
    return Vec3{at(0), at(1), at(2)};
  };
  for (std::uint32_t n = 0; n < 90; ++n) {
    std::array corners{node(), node(), node()};
    for (int axis = 0; axis < static_cast<int>(n % 4); ++axis) corners[1][axis] = corners[2][axis] = corners[0][axis];
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  expect_triangles_of_cells(mesh);
}

// The cap of a finely tessellated cylinder: each of its needles has the cap's plane, and a box of a tenth of the cap.
TEST(CellTriangles, OfAFanOfNeedlesAreFew) {
  constexpr std::uint32_t kSegments = 3000;
  const SurfaceCells cells = many_cells();
  const Vec3 centre{-0.5, 1.3, 17.0}, u{2.0, 0.7, 1.1}, v{-0.6, 1.0, 3.9};
  TriangleMesh fan{{centre}, {}};
  for (std::uint32_t n = 0; n < kSegments; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kSegments;
    fan.vertices.push_back(centre + std::cos(angle) * u + std::sin(angle) * v);
    fan.triangles.push_back({0, n + 1, (n + 1) % kSegments + 1});
  }
  const CellTriangles found(fan, cells);
  std::size_t all = 0;
  for (std::uint32_t cell = 0; cell < cells.cells().size(); ++cell) all += found.of(cell).size();
  EXPECT_GT(all, kSegments);
  EXPECT_LT(all, 15 * kSegments);  // by planes and boxes alone there are 25
}

// Beyond what can be clipped, all cells of the box are taken.
TEST(CellTriangles, MayBeHuge) {
  const SurfaceCells cells = many_cells();
  for (const double size : {1e15, 1e200, 1e308}) {
    const TriangleMesh mesh{{{-size, -size, 12.0}, {size, -size, 12.5}, {0.0, size, 12.25}}, {{0, 1, 2}}};
    const CellTriangles found(mesh, cells);
    for (std::uint32_t cell = 0; cell < cells.cells().size(); ++cell) {
      const double low = cells.position(cells.cells()[cell].node).z;
      const bool is_beside = low > 13.0 || low + kLattice.spacing.z < 11.5;
      if (low < 12.0 && low + kLattice.spacing.z > 12.5) {
        EXPECT_EQ(found.of(cell).size(), 1U);
      }
      if (is_beside) {
        EXPECT_TRUE(found.of(cell).empty());
      }
    }
  }
}

}  // namespace
}  // namespace raycone
