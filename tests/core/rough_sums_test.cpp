// Rough sums of solid angles against direct ones: nothing is off by more than what is said, wherever boxes lie.
#include "core/evaluation/rough_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/boundary/solid_angles.h"
#include "core/far/lattice_blocks.h"
#include "tests/support/expansion_error.h"
#include "tests/support/lattice_rows.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;

double direct_sum(std::span<const SolidTriangle> triangles, const Vec3& q) {
  SampleTile tile;
  tile.clear();
  tile.add(q);
  tile.fill_up();
  ProductTile products;
  solid_angle_kernel(SimdLevel::kBest)(triangles, tile, products);
  return static_cast<double>(products.turns(0)) + products.argument[0];
}

// What boxes of a lattice have shown.
struct Seen {
  double closest = 0.0;  // error over what it may be, at most
  double largest = 0.0;  // that any sum may be off by
  int smooth = 0, not_smooth = 0;
};

SampleBox random_box(Random& random, const SampleBox& in, std::size_t longest) {
  SampleBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t side = 1 + random() % std::min(in.side(axis), longest);
    box.begin[axis] = in.begin[axis] + random() % (in.side(axis) - side + 1);
    box.end[axis] = box.begin[axis] + side;
  }
  return box;
}

// A box that may be evaluated.
void compare(std::span<const SolidTriangle> triangles, const LatticeRows& rows, RoughSums& sums, const RoughBox& rough,
             Seen& seen) {
  const SampleBox& box = rough.samples;
  const RoughSums::Range range = RoughSums::range(rough);
  ++(rough.is_smooth() ? seen.smooth : seen.not_smooth);
  std::vector<double> numbers;
  const double off = sums.evaluate(rough, numbers);
  const BoxSums of_box{numbers, box};
  seen.largest = std::max(seen.largest, off);
  for (std::size_t z = box.begin[2]; z < box.end[2]; ++z) {
    for (std::size_t y = box.begin[1]; y < box.end[1]; ++y) {
      for (std::size_t x = box.begin[0]; x < box.end[0]; ++x) {
        const double w = direct_sum(triangles, rows.query({x, y, z}));
        const double error = std::abs(of_box.row(y, z)[x - box.begin[0]] - w);
        ASSERT_LE(error, off) << x << ' ' << y << ' ' << z;
        seen.closest = std::max(seen.closest, error / off);
        if (rough.is_smooth()) {
          ASSERT_LE(std::abs(w - range.middle), range.off) << x << ' ' << y << ' ' << z;
        }
      }
    }
  }
}

// Boxes of up to 16 samples along each axis, some of them of one, at random: by themselves, and as parts of parts of
// the lattice.
Seen look_at_boxes(const TriangleMesh& mesh, const LatticeRows& rows, double each, int boxes) {
  const std::vector<SolidTriangle> triangles = solid_faces(mesh).triangles;
  const LatticeBlocks blocks(triangles, 1e-6, SimdLevel::kBest, LatticeBlocks::Near::kBoundary);
  RoughSums sums(blocks, rows);
  Random random(7);
  Seen seen;
  const SampleBox lattice{{0, 0, 0}, {rows.xs.size(), rows.ys.size(), rows.zs.size()}};
  const RoughBox whole = sums.look_at(lattice, each, nullptr);
  for (int n = 0; n < boxes && !testing::Test::HasFatalFailure(); ++n) {
    const RoughBox part = sums.look_at(random_box(random, lattice, 40), each, &whole);
    const RoughBox of_part = sums.look_at(random_box(random, part.samples, 16), each, &part);
    compare(triangles, rows, sums, of_part, seen);
    compare(triangles, rows, sums, sums.look_at(of_part.samples, each, nullptr), seen);
  }
  return seen;
}

// Three quarters of a sphere, with slivers around its opening and a long needle through it.
TriangleMesh scraps() {
  TriangleMesh mesh = test::moved(test::sphere(16), {0.4, 0.4, 0.4}, {0.01, 0.02, 0.03});
  mesh.triangles.resize(mesh.triangles.size() * 3 / 4);
  test::add_triangle(mesh, {-0.5, 0.1, 0.1}, {0.5, 0.11, 0.1}, {0.5, 0.12, 0.11});
  return mesh;
}

TEST(RoughSumsTest, AreOffByNoMoreThanTheySay) {
  const LatticeRows rows = test::rows_of({{-0.6, -0.5, -0.55}, {0.0125, 0.0125, 0.0125}, {0, 0, 0}, {96, 80, 88}});
  for (const double each : {0.1, 4e-3, 1e-4, 1e-7}) {
    const Seen seen = look_at_boxes(scraps(), rows, each, 60);
    EXPECT_GT(seen.closest, 1e-4) << each << ": bounds that nothing comes near are of no use";
    EXPECT_LT(seen.largest, 100 * each);
    EXPECT_GT(seen.not_smooth, 0);
  }
}

TEST(RoughSumsTest, OfLatticesThatAreFlatOrStretched) {
  const TriangleMesh mesh = scraps();
  for (const LatticeRows& rows : {test::rows_of({{-0.7, -0.7, 0.05}, {0.025, 0.025, 1}, {0, 0, 0}, {60, 60, 1}}),
                                  test::rows_of({{0.1, -0.6, -0.7}, {1, 0.025, 0.025}, {0, 0, 0}, {1, 50, 60}}),
                                  test::rows_of({{-0.6, -0.5, -0.6}, {0.04, 0.01, 0.06}, {0, 0, 0}, {30, 90, 20}})}) {
    (void)look_at_boxes(mesh, rows, 4e-3, 60);
  }
}

// Samples on vertices, edges and faces of a mesh, and level with them.
TEST(RoughSumsTest, OfLatticesThatAreFullOfTies) {
  TriangleMesh box = test::moved(test::open_box(), {0.5, 0.5, 0.5}, {0, 0, 0});
  (void)look_at_boxes(box, test::rows_of({{-0.75, -0.75, -0.75}, {0.03125, 0.03125, 0.03125}, {0, 0, 0}, {49, 49, 49}}),
                      4e-3, 120);
}

// From farther and farther away: interpolation, and leaving out, take over from sums at each sample.
Seen look_from_afar(const TriangleMesh& mesh) {
  const std::vector<SolidTriangle> triangles = solid_faces(mesh).triangles;
  const LatticeBlocks blocks(triangles, 1e-6, SimdLevel::kBest);
  Seen seen;
  for (int step = 0; step < 60; ++step) {
    const double away = 0.005 * std::pow(1.07, step);
    const LatticeRows rows = test::rows_of({{-0.02, -0.02, away}, {0.006, 0.006, 0.006}, {0, 0, 0}, {8, 8, 8}});
    RoughSums sums(blocks, rows);
    for (double each = 1e-2; each > 1e-7; each /= 4) {
      compare(triangles, rows, sums, sums.look_at({{0, 0, 0}, {8, 8, 8}}, each, nullptr), seen);
    }
  }
  EXPECT_GT(seen.smooth, 20);
  EXPECT_GT(seen.not_smooth, 20);
  return seen;
}

TEST(RoughSumsTest, OfOneTriangleFromAfar) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.01, 0, 0.002}, {0, 0.01, 0.001}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_GT(look_from_afar(mesh).closest, 0.05);
}

// Much longer than it is away, and much wider: what is farther off than the nearest point counts for less.
TEST(RoughSumsTest, OfLongAndOfWideTrianglesFromNearby) {
  for (const double width : {1e-3, 0.1, 2.0}) {
    TriangleMesh mesh;
    mesh.vertices = {{-3, -width, 0}, {0.2, 0, 0.01}, {3, -width, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_GT(look_from_afar(mesh).closest, 0.01) << width;
    mesh.vertices = {{-3, 0, 0}, {3, 0, 0.01}, {0.2, width, 0}};
    EXPECT_GT(look_from_afar(mesh).closest, 0.003) << width;
  }
}

// A node of the tree, whose expansion is exact to many digits.
TEST(RoughSumsTest, OfAPatchFromAfar) {
  TriangleMesh mesh;
  constexpr std::uint32_t kSide = 4;
  for (std::uint32_t i = 0; i <= kSide; ++i) {
    for (std::uint32_t j = 0; j <= kSide; ++j) mesh.vertices.push_back({0.002 * i, 0.002 * j, 0});
  }
  for (std::uint32_t i = 0; i < kSide; ++i) {
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const std::uint32_t a = i * (kSide + 1) + j, b = a + kSide + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
    }
  }
  EXPECT_GT(look_from_afar(mesh).closest, 0.05);
}

TEST(RoughSumsTest, LeastCutIsTheLeastThatErrsByNoMore) {
  const SourceTree tree(solid_faces(scraps()).triangles, 1e-6, SimdLevel::kBest, {});
  const SourceNode& root = tree.nodes().front();
  int nothing = 0, cut_off = 0, none = 0;
  for (double distance = 1.01 * root.radius; distance < 1e5; distance *= 1.5) {
    for (const double most : {1e-1, 1e-4, 1e-8, 1e-13}) {
      const auto cut = SourceTree::least_cut(root, distance, most);
      if (!cut) {
        EXPECT_GT(test::expansion_error(root, root.order, distance), most * (1 - 1e-9));
        ++none;
        continue;
      }
      ++(cut->degree == 0 ? nothing : cut_off);
      EXPECT_LE(cut->error, most);
      EXPECT_NEAR(cut->error, test::expansion_error(root, cut->degree, distance), 1e-9 * cut->error);
      if (cut->degree > 0) {
        EXPECT_GT(test::expansion_error(root, cut->degree - 1, distance), most * (1 - 1e-9));
      }
    }
  }
  EXPECT_GT(nothing, 0);
  EXPECT_GT(cut_off, 0);
  EXPECT_GT(none, 0);
}

}  // namespace
}  // namespace raycone
