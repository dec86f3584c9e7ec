#include "core/evaluation/rule_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/weld.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"
#ifdef RAYCONE_SHARED_MESHES  // tests/mutants builds no readers
#include "io/mesh/read_mesh.h"
#endif

namespace raycone {
namespace {

const std::vector<Rule> kRules{{RuleKind::kThreshold, 0.5}, {RuleKind::kThreshold, 0.25}, {RuleKind::kThreshold, -0.75},
                               {RuleKind::kAbs, 0.1},       {RuleKind::kNonzero, 0.5},    {RuleKind::kPositive, 0.5},
                               {RuleKind::kOdd, 0.5}};

// Over the mesh's box and a tenth of its size around it.
Lattice lattice_around(const TriangleMesh& mesh, std::int64_t count) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double side = std::max({size.x, size.y, size.z});
  Lattice lattice;
  const double h = 1.2 * side / static_cast<double>(count - 1);
  lattice.spacing = {h, h, h};
  lattice.origin = box.lower - Vec3{side / 10, side / 10, side / 10};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.counts[static_cast<std::size_t>(axis)] = 1 + static_cast<std::int64_t>((size[axis] + side / 5) / h);
  }
  return lattice;
}

// With corners on integers: samples on faces, edges, vertices and in the planes of openings.
Lattice integers(std::int64_t from, std::int64_t count, double spacing) {
  return {{0, 0, 0}, {spacing, spacing, spacing}, {from, from, from}, {count, count, count}};
}

// Whether the rule holds at q, where the value is w.
bool holds_at(const WindingNumberEvaluator& evaluator, const Rule& rule, const Vec3& q, double w) {
  for (const double threshold : thresholds_to_settle(rule)) {
    if (std::abs(w - threshold) <= evaluator.doubt()) evaluator.settle({&q, 1}, threshold, {&w, 1});
  }
  return holds(rule, w);
}

constexpr std::int64_t kWrong = std::numeric_limits<std::int64_t>::min();

// How many samples are not evaluated one by one, of all rules together; negative where many are evaluated twice, and
// kWrong where a rule is wrong somewhere.
std::int64_t certified(const TriangleMesh& mesh, const Lattice& lattice) {
  const WindingNumberEvaluator evaluator(mesh);
  const std::vector<double> truth = test::values_of(evaluator, lattice);
  const std::size_t size = truth.size();
  std::vector<std::uint8_t> sides(size);
  const std::uint64_t edges = std::max<std::uint64_t>(evaluator.exterior_edges(), 1);
  std::uint64_t terms = 0;
  for (const Rule& rule : kRules) {
    const std::uint64_t before = evaluator.terms().near;
    evaluator.evaluate_sides(rule, lattice, whole(lattice), sides);
    terms += evaluator.terms().near - before;
    for (std::size_t n = 0; n < size; ++n) {
      const Vec3 q = lattice.position(whole(lattice).index_of(n));
      if ((sides[n] != 0) != holds_at(evaluator, rule, q, truth[n])) return kWrong;
    }
  }
  const auto evaluated = static_cast<std::int64_t>(terms / edges);
  return static_cast<std::int64_t>(kRules.size() * size) - evaluated;
}

TEST(RuleBlocks, HoldWhereTheWindingNumbersDo) {
  const TriangleMesh ball = test::sphere(12);
  TriangleMesh holes = ball;  // twelve of different sizes
  std::erase_if(holes.triangles, [&](const Triangle& t) { return (t[0] * 7 + t[1] + t[2]) % 23 == 0; });
  for (const TriangleMesh& mesh :
       {holes, test::joined(holes, test::reversed(test::moved(holes, {0.5, 0.5, 0.5}, {0.1, 0.2, 0.3}))),
        test::joined(holes, holes)}) {
    const std::int64_t count = certified(weld(mesh, {}), lattice_around(mesh, 50));
    EXPECT_GT(count, 7 * 60'000) << "few are certified";
  }
}

TEST(RuleBlocks, HoldOnLatticesThatAreFullOfTies) {
  EXPECT_GT(certified(test::open_box(), integers(-8, 65, 1.0 / 32)), 100'000);
  EXPECT_GT(certified(test::moved(test::open_box(), {-1, 1, 1}, {0, 0, 0}), integers(-40, 65, 1.0 / 32)), 100'000);
  test::Random random(4);
  for (int i = 0; i < 4; ++i) {
    TriangleMesh cells = test::random_cells(random, 4);
    std::size_t n = 0;  // holes enough: of few edges values tell, not certificates
    std::erase_if(cells.triangles, [&](const Triangle&) { return n++ % 20 == 0; });
    EXPECT_GT(certified(weld(cells, {}), integers(-4, 41, 0.125)), 100'000);
    EXPECT_GT(certified(test::lattice_soup(random, 30, 4), integers(-6, 33, 0.25)), 100'000);
  }
}

// A funnel, open at both ends: rays from the wide opening's caps pass through the narrow one, or do not.
TEST(RuleBlocks, HoldWhereTheConesOfOneOpeningMeetTheCapsOfAnother) {
  constexpr std::uint32_t kCorners = 24;
  TriangleMesh funnel;
  for (std::uint32_t n = 0; n < kCorners; ++n) {
    const double angle = 2 * std::numbers::pi * n / kCorners;
    funnel.vertices.push_back({0.01, std::cos(angle), std::sin(angle)});
    funnel.vertices.push_back({2, 0.4 * std::cos(angle), 0.4 * std::sin(angle)});
    const std::uint32_t a = 2 * n, b = 2 * ((n + 1) % kCorners);
    funnel.triangles.push_back({a, b, a + 1});
    funnel.triangles.push_back({b, b + 1, a + 1});
  }
  for (const TriangleMesh& mesh : {funnel, test::reversed(funnel)}) {
    EXPECT_GT(certified(weld(mesh, {}), lattice_around(mesh, 60)), 7 * 60'000);
  }
}

// The origin sees an octant: an eighth of a turn, whatever rounding makes of it.
TEST(Sides, AreSettledWhereTheWindingNumberIsTheThreshold) {
  const Rule rule{RuleKind::kThreshold, 0.125};
  const Lattice lattice = integers(-1, 3, 1.0);
  test::Random random(6);
  int below = 0;
  for (int i = 0; i < 200; ++i) {
    TriangleMesh octant;
    octant.vertices = {
        {test::uniform(random, 1, 9), 0, 0}, {0, test::uniform(random, 1, 9), 0}, {0, 0, test::uniform(random, 1, 9)}};
    octant.triangles = {{0, 1, 2}};
    const WindingNumberEvaluator evaluator(octant);
    const std::vector<double> values = test::values_of(evaluator, lattice);
    std::vector<std::uint8_t> sides(values.size());
    evaluator.evaluate_sides(rule, lattice, whole(lattice), sides);
    EXPECT_EQ(sides[13], 1) << values[13];
    below += values[13] < 0.125;
  }
  EXPECT_GT(below, 0) << "no value is rounded down: nothing was tested";
}

// In a stack of tetrahedra w is large, and rounded: nothing is left there of a triangle far away, which decides the
// sides of all other samples.
TEST(Sides, HoldBesideLargeWindingNumbers) {
  constexpr std::size_t kCopies = std::size_t{1} << 17;
  TriangleMesh mesh{{{0.3, 0.3, 0.3}, {0.9, 0.3, 0.3}, {0.3, 0.9, 0.3}, {0.3, 0.3, 0.9}}, {}};
  for (std::size_t n = 0; n < kCopies; ++n) {
    for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) mesh.triangles.push_back(t);
  }
  mesh = test::joined(mesh, {{{10, 0, 0}, {10, 1.69e-4, 0}, {10, 0, 1.69e-4}}, {{0, 1, 2}}});
  const Lattice lattice{{0, 0, 0}, {1.0 / 5600, 0.14, 0.14}, {0, 0, 0}, {5600, 8, 8}};
  const WindingNumberEvaluator evaluator(mesh);
  const std::vector<Vec3> corners{{0, 1, 1}, {1, 0, 0}};
  std::vector<double> w(2);
  evaluator.evaluate(corners, w);
  ASSERT_GT(w[0], 1e-11);    // the least of all samples outside
  ASSERT_LT(w[1], 0x1p-36);  // the most: half a unit of 2^17
  std::vector<std::uint8_t> sides(static_cast<std::size_t>(whole(lattice).size()));
  evaluator.evaluate_sides({RuleKind::kThreshold, w[0] / 2}, lattice, whole(lattice), sides);
  EXPECT_EQ(std::ranges::count(sides, 0), 0);
}

// Of a block of a lattice, with rough sums, against winding numbers without tolerance. Returns what sides took.
// `samples`: how many the evaluator is told of.
Terms expect_sides_to_hold(const TriangleMesh& mesh, const Lattice& lattice, const LatticeBlock& block,
                           double samples = 1e6) {
  const WindingNumberEvaluator exact(mesh, {.accuracy = {.tolerance = 0.0}});
  const WindingNumberEvaluator roughly(mesh, {.accuracy = {.tolerance = 3e-5, .samples = samples, .sides_only = true}});
  const auto size = static_cast<std::size_t>(block.size());
  std::vector<double> truth(size);
  exact.evaluate(lattice, block, truth);
  for (const Rule& rule : kRules) {
    std::vector<std::uint8_t> sides(size);
    std::atomic<std::uint64_t> done = 0;
    roughly.evaluate_sides(rule, lattice, block, sides, &done);
    EXPECT_EQ(done, size);
    for (std::size_t n = 0; n < size; ++n) {
      if ((sides[n] != 0) != holds_at(exact, rule, lattice.position(block.index_of(n)), truth[n])) {
        ADD_FAILURE() << "sample " << n;
        return {};
      }
    }
    EXPECT_GT(std::ranges::count(sides, 1), 100);
  }
  return roughly.terms();
}

void expect_rough_sums_to_hold(const TriangleMesh& mesh, const Lattice& lattice, const LatticeBlock& block) {
  const Terms terms = expect_sides_to_hold(mesh, lattice, block);
  const auto size = static_cast<std::size_t>(block.size());
  EXPECT_GT(terms.far, 0U) << "no expansion was summed: nothing was tested";
  EXPECT_LT(terms.near, kRules.size() * size * exterior_edges(mesh).size() / 4) << "most was summed edge by edge";
}

// Certificates decide little; samples begin in the middle of rows and of blocks.
TEST(Sides, HoldByRoughSums) {
  const TriangleMesh mesh = test::sieve(16, 8);
  EXPECT_LT(exterior_edges(mesh).size(), 1000U);
  expect_rough_sums_to_hold(mesh, lattice_around(mesh, 100), {{5, 3, 40}, {80, 75, 12}});
}

// From a thousand exterior edges on, one for ten faces or more.
TEST(Sides, HoldByRoughSumsAlone) {
  const TriangleMesh mesh = test::sieve(30, 8);
  const std::size_t edges = exterior_edges(mesh).size();
  EXPECT_GE(edges, 1000U);
  EXPECT_GT(10 * edges, mesh.triangles.size());
  expect_rough_sums_to_hold(mesh, lattice_around(mesh, 100), {{5, 3, 40}, {80, 75, 12}});
}

// Some of the blocks wait for the tree, since certificates decide others.
TEST(Sides, HoldByRoughSumsWhereFewBlocksNeedThem) {
  const TriangleMesh mesh = test::sieve(30, 50);
  EXPECT_LT(10 * exterior_edges(mesh).size(), mesh.triangles.size());
  expect_rough_sums_to_hold(mesh, lattice_around(mesh, 140), {{0, 0, 60}, {140, 140, 9}});
}

// A soup: no two triangles of a sphere meet. Where there are few samples, their values tell.
TEST(Sides, HoldByRoughSumsOfSoups) {
  const TriangleMesh mesh = test::shrunk_faces(test::sphere(16), 0.95);
  EXPECT_EQ(exterior_edges(mesh).size(), 3 * mesh.triangles.size());
  const LatticeBlock block{{5, 3, 40}, {80, 75, 12}};
  const Lattice lattice = lattice_around(mesh, 100);
  const Terms by_values = expect_sides_to_hold(mesh, lattice, block, 1000);
  const Terms by_rough_sums = expect_sides_to_hold(mesh, lattice, block);
  EXPECT_GT(by_rough_sums.far, 0U);
  EXPECT_LT(by_rough_sums.near, by_values.near / 2);
}

// On corners, edges and faces, one of which is there twice, or both ways: ties of rough sums.
TEST(Sides, HoldByRoughSumsOfSoupsFullOfTies) {
  test::Random random(9);
  for (const std::size_t copies : {1U, 2U}) {
    TriangleMesh mesh = test::lattice_soup(random, 60, 4);
    for (std::size_t n = 1; n < copies; ++n) mesh.triangles.push_back(mesh.triangles.front());
    const Triangle t = mesh.triangles.back();
    mesh.triangles.push_back({t[0], t[2], t[1]});
    EXPECT_GE(exterior_edges(mesh).size(), 100U);
    const Lattice lattice = integers(-6, 49, 0.25);
    (void)expect_sides_to_hold(mesh, lattice, whole(lattice));
  }
}

// Cracks: every third triangle has a corner more on one side, which its neighbour has not.
TEST(RuleBlocks, SeeThroughCracks) {
  TriangleMesh mesh = test::sphere(12);
  const std::vector<Triangle> whole_triangles = mesh.triangles;
  for (std::size_t n = 0; n < whole_triangles.size(); n += 3) {
    const Triangle& t = whole_triangles[n];
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]];
    mesh.vertices.push_back(0.3 * a + 0.7 * b);
    mesh.triangles[n] = {t[0], v, t[2]};
    mesh.triangles.push_back({v, t[1], t[2]});
  }
  const Lattice lattice = lattice_around(mesh, 64);
  const std::int64_t all = whole(lattice).size() * static_cast<std::int64_t>(kRules.size());
  EXPECT_GT(certified(weld(mesh, {}), lattice), all / 2);
}

#ifdef RAYCONE_SHARED_MESHES
TEST(RuleBlocks, HoldOnRealOpenMeshes) {
  int meshes = 0;
  for (const char* name : {"meshes__plane_holes.obj", "geometry-central__moebius.obj", "thingi10k/52863.stl",
                           "trimesh__featuretype.STL", "fast-winding-number-soups__pig-head.ply"}) {
    const std::filesystem::path path = std::filesystem::path(RAYCONE_SHARED_MESHES) / name;
    if (!std::filesystem::exists(path)) continue;
    const TriangleMesh mesh = weld(read_mesh(path, {}).parsed.mesh, {});
    EXPECT_GE(certified(mesh, lattice_around(mesh, 24)), 0) << name;
    ++meshes;
  }
  if (meshes == 0) GTEST_SKIP() << "no shared meshes";
}
#endif

// Two halves that touch in vertices of their own: edges there and back, which no cap fills.
TEST(RuleBlocks, OfMeshesWithSeams) {
  TriangleMesh halves = test::sphere(12);
  const std::vector<Vec3> shared = halves.vertices;
  halves.vertices.insert(halves.vertices.end(), shared.begin(), shared.end());
  for (Triangle& t : halves.triangles) {
    const double middle = shared[t[0]].z + shared[t[1]].z + shared[t[2]].z;
    for (std::uint32_t& v : t) v += middle > 0.0 ? static_cast<std::uint32_t>(shared.size()) : 0U;
  }
  EXPECT_GT(exterior_edges(halves).size(), 40U);
  EXPECT_GT(certified(halves, integers(-20, 41, 0.0625)), 0);
}

}  // namespace
}  // namespace raycone
