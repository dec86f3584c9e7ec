// The evaluator against the oracle, against the laws of winding numbers, and on every kind of degeneracy.
#include "core/evaluation/winding_number.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>

#include "core/exact/predicates.h"
#include "core/machine/threads.h"
#include "core/mesh/weld.h"
#include "tests/support/differences.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::largest_difference;
using test::Random;

// Rounding of some u per exterior edge: for the few hundred edges of these meshes 1e-13 is about ten times the largest
// error seen, and a thousand times below anything that a wrong digit would cause.
constexpr double kRounding = 1e-13;

std::vector<double> values_of(const TriangleMesh& mesh, const std::vector<Vec3>& queries, Tally* tally = nullptr) {
  std::vector<double> values(queries.size());
  const Tally sum = WindingNumberEvaluator(mesh).evaluate(queries, values);
  if (tally) *tally = sum;
  return values;
}

std::vector<Vec3> random_queries(Random& random, const Box& box, int count) {
  std::vector<Vec3> queries;
  for (int i = 0; i < count; ++i) queries.push_back(test::uniform_point(random, box));
  return queries;
}

double largest_error(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  std::vector<double> expected;
  for (const Vec3& q : queries) expected.push_back(test::direct_winding_number(mesh, q));
  return largest_difference(values_of(mesh, queries), expected);
}

const Box kAroundUnitCube{{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}};

// --- Oracle ---

TEST(WindingNumber, OfSoupsIsTheDirectSum) {
  Random random(1);
  for (const int triangles : {1, 2, 10, 100}) {
    const TriangleMesh mesh = weld(test::soup(random, triangles), {});
    EXPECT_LT(largest_error(mesh, random_queries(random, kAroundUnitCube, 1000)), kRounding);
  }
}

TEST(WindingNumber, OfFansWithHighMultiplicitiesIsTheDirectSum) {
  Random random(2);
  for (int triangles = 2; triangles <= 7; ++triangles) {
    for (int same = 0; same <= triangles; ++same) {
      EXPECT_LT(largest_error(test::fan(triangles, same), random_queries(random, {{-1, -1, -1}, {1, 1, 2}}, 200)),
                kRounding);
    }
  }
}

TEST(WindingNumber, OfClosedMeshesIsAnIntegerExactly) {
  Random random(3);
  for (const TriangleMesh& mesh : {test::sphere(12), test::random_cells(random, 4)}) {
    const std::vector<Vec3> queries = random_queries(random, {{-1, -1, -1}, {4, 4, 4}}, 2000);
    const std::vector<double> values = values_of(mesh, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      EXPECT_EQ(values[i], std::nearbyint(values[i]));
      EXPECT_NEAR(values[i], test::direct_winding_number(mesh, queries[i]), 1e-12);
    }
  }
}

// --- Laws ---

TEST(WindingNumber, ReversalNegatesToTheBit) {
  Random random(4);
  const TriangleMesh mesh = test::joined(test::lattice_soup(random, 30, 4), test::open_box());
  const std::vector<Vec3> queries = random_queries(random, {{-1, -1, -1}, {5, 5, 5}}, 1000);
  const std::vector<double> forward = values_of(mesh, queries), backward = values_of(test::reversed(mesh), queries);
  for (std::size_t i = 0; i < queries.size(); ++i) EXPECT_EQ(forward[i], -backward[i]);
}

TEST(WindingNumber, OfAUnionIsTheSum) {
  Random random(5);
  const TriangleMesh a = test::open_box(), b = weld(test::soup(random, 20), {});
  const std::vector<Vec3> queries = random_queries(random, kAroundUnitCube, 1000);
  std::vector<double> sum = values_of(a, queries);
  const std::vector<double> second = values_of(b, queries);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += second[i];
  EXPECT_LT(largest_difference(values_of(test::joined(a, b), queries), sum), kRounding);
}

TEST(WindingNumber, OrderOfFacesAndVerticesChangesNoBit) {
  Random random(6);
  const TriangleMesh mesh = test::joined(test::lattice_soup(random, 40, 4), weld(test::soup(random, 40), {}));
  std::vector<Vec3> queries = random_queries(random, {{-1, -1, -1}, {5, 5, 5}}, 300);
  for (int i = 0; i < 125; ++i) queries.push_back({i % 5 * 1.0, i / 5 % 5 * 1.0, i / 25 * 1.0});
  Tally expected_tally, tally;
  const std::vector<double> expected = values_of(mesh, queries, &expected_tally);
  EXPECT_GT(expected_tally.degenerate, 0U);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(values_of(test::shuffled(mesh, random), queries, &tally), expected);
    EXPECT_EQ(tally.degenerate, expected_tally.degenerate);
    EXPECT_EQ(tally.on_surface, expected_tally.on_surface);
  }
}

TEST(WindingNumber, SubdividingAFlatFaceChangesNothing) {
  // The quadrilateral (0,0) (4,0) (4,4) (0,4) as two triangles and, split at (1, 2), as four.
  const std::vector<Vec3> corners{{0, 0, 0}, {4, 0, 1}, {4, 4, 2}, {0, 4, 1}, {1, 2, 0.75}};
  const TriangleMesh coarse{corners, {{0, 1, 2}, {0, 2, 3}}};
  const TriangleMesh fine{corners, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  Random random(7);
  const std::vector<Vec3> queries = random_queries(random, {{-1, -1, -1}, {5, 5, 3}}, 1000);
  EXPECT_LT(largest_difference(values_of(coarse, queries), values_of(fine, queries)), 1e-12);
}

TEST(WindingNumber, WeldingChangesNoValue) {
  Random random(8);
  TriangleMesh unwelded;
  const TriangleMesh mesh = test::sphere(6);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) unwelded.vertices.push_back(mesh.vertices[v]);
    const auto n = static_cast<std::uint32_t>(unwelded.vertices.size());
    unwelded.triangles.push_back({n - 3, n - 2, n - 1});
  }
  const std::vector<Vec3> queries = random_queries(random, {{-1, -1, -1}, {1, 1, 1}}, 500);
  EXPECT_LT(largest_difference(values_of(mesh, queries), values_of(unwelded, queries)), kRounding);
}

TEST(WindingNumber, ScalingByAPowerOfTwoChangesNoBit) {
  Random random(9);
  const TriangleMesh mesh = test::joined(test::open_box(), weld(test::soup(random, 10), {}));
  const std::vector<Vec3> queries = random_queries(random, kAroundUnitCube, 300);
  const std::vector<double> expected = values_of(mesh, queries);
  for (const double scale : {0x1p-900, 0x1p-400, 0x1p-3, 0x1p400, 0x1p900}) {
    std::vector<Vec3> scaled_queries;
    for (const Vec3& q : queries) scaled_queries.push_back(scale * q);
    EXPECT_EQ(values_of(test::moved(mesh, {scale, scale, scale}, {}), scaled_queries), expected) << scale;
  }
}

TEST(WindingNumber, JumpsByOneAcrossTheSurfaceOnly) {
  const TriangleMesh mesh = test::open_box();
  const double step = 1e-9;
  const std::vector<double> v =
      values_of(mesh, {{0.3, 0.4, -step}, {0.3, 0.4, step}, {0.3, 0.4, 1 - step}, {0.3, 0.4, 1 + step}});
  EXPECT_NEAR(v[1] - v[0], 1.0, 1e-8);
  EXPECT_NEAR(v[3] - v[2], 0.0, 1e-8);  // the open side
}

// --- Degeneracies ---

// Compares with the query actually moved as the perturbation has it, in 113 bits. Fractional parts differ by the step.
void expect_perturbed_values(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  constexpr double kStep = 1e-9;
  const std::vector<double> values = values_of(mesh, queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    ASSERT_NEAR(values[i], test::perturbed_winding_number(mesh, queries[i], kStep), 1e-6)
        << "at " << queries[i].x << " " << queries[i].y << " " << queries[i].z;
  }
}

std::vector<Vec3> nodes(int size, double step) {
  std::vector<Vec3> queries;
  for (double x = -step; x <= size + step; x += step) {
    for (double y = 0; y <= size; y += step) {
      for (double z = 0; z <= size; z += step) queries.push_back({x, y, z});
    }
  }
  return queries;
}

TEST(WindingNumber, AtNodesOfLatticeSoupsIsThatOfThePerturbedQuery) {
  Random random(10);
  for (int triangles = 1; triangles <= 24; ++triangles) {
    expect_perturbed_values(test::lattice_soup(random, triangles, 3), nodes(3, 0.5));
  }
}

TEST(WindingNumber, AtNodesOfRandomCellsIsThatOfThePerturbedQuery) {
  Random random(11);
  for (int i = 0; i < 3; ++i) expect_perturbed_values(test::random_cells(random, 3), nodes(3, 0.5));
}

// Crossings that count a tie as "inside" in each triangle by itself, as a half-open rule without a shared edge sign
// does.
int crossings_without_shared_ties(const TriangleMesh& mesh, const Vec3& q) {
  int n = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const auto side = [&](const Vec3& u, const Vec3& v) {
      return (u.y - q.y) * (v.z - q.z) - (u.z - q.z) * (v.y - q.y);
    };
    const double ab = side(a, b), bc = side(b, c), ca = side(c, a);
    const double volume = dot(cross(b - a, c - a), q - a);
    if (ab >= 0 && bc >= 0 && ca >= 0 && ab + bc + ca > 0 && volume < 0) ++n;
    if (ab <= 0 && bc <= 0 && ca <= 0 && ab + bc + ca < 0 && volume > 0) --n;
  }
  return n;
}

TEST(WindingNumber, DegenerateLatticesTellASharedTieBreakFromNone) {  // negative control of the two tests above
  Random random(11);
  const TriangleMesh mesh = test::random_cells(random, 3);
  int wrong = 0;
  for (const Vec3& q : nodes(3, 0.5)) {
    wrong += std::abs(crossings_without_shared_ties(mesh, q) - test::perturbed_winding_number(mesh, q, 1e-9)) > 0.5;
  }
  EXPECT_GT(wrong, 100);
}

TEST(WindingNumber, OfAClosedBoxLowerFacesAreInsideAndUpperOutside) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  for (int i = 0; i < 27; ++i) {
    const Vec3 q{i % 3 * 0.5, i / 3 % 3 * 0.5, i / 9 * 0.5};
    Tally tally;
    const double w = values_of(box, {q}, &tally)[0];
    EXPECT_EQ(w, q.x < 1 && q.y < 1 && q.z < 1 ? 1.0 : 0.0) << q.x << " " << q.y << " " << q.z;
    EXPECT_EQ(tally.on_surface, i == 13 ? 0U : 1U);
  }
}

TEST(WindingNumber, OnSurfaceIsFlaggedWhereDuplicatesCancelAndOnDegenerateTriangles) {
  const std::vector<Vec3> v{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 5}};
  const TriangleMesh cancelling{v, {{0, 1, 2}, {0, 2, 1}, {3, 4, 5}}};
  Tally tally;
  const std::vector<double> w = values_of(cancelling, {{0.25, 0.25, 0.5}, {4, 4, 4}, {0.25, 0.25, 0.6}}, &tally);
  // The two opposite faces cancel as chains; the segment's three edges are summed, and leave their rounding.
  for (const double value : w) EXPECT_NEAR(value, 0.0, 1e-16);
  EXPECT_EQ(tally.on_surface, 2U);
}

TEST(WindingNumber, RaysThroughVerticesAndAlongEdgesOfOpenMeshes) {
  Random random(12);
  const TriangleMesh mesh = test::joined(test::open_box(), weld(test::soup(random, 12), {}));
  std::vector<Vec3> queries;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]];
    for (const double x : {-0.7, 0.31, 1.3}) {
      queries.push_back({x, a.y, a.z});                              // through a vertex, before and behind it
      queries.push_back({x, 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)});  // across an edge
    }
  }
  std::erase_if(queries, [&](const Vec3& q) {  // where w jumps the oracle has no value
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      return on_triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], q);
    });
  });
  EXPECT_GT(queries.size(), 80U);
  EXPECT_LT(largest_error(mesh, queries), kRounding);
}

TEST(WindingNumber, CountsTiesOncePerEdgeOfEachTriangleAhead) {
  // One triangle in the plane x = 1; rays through a corner tie with two edges, through an edge with one.
  const TriangleMesh mesh{{{1, 0, 0}, {1, 4, 0}, {1, 0, 4}}, {{0, 1, 2}}};
  const auto degenerate = [&](const Vec3& q) {
    Tally tally;
    values_of(mesh, {q}, &tally);
    return tally.degenerate;
  };
  EXPECT_EQ(degenerate({0, 0, 0}), 2U);
  EXPECT_EQ(degenerate({0, 2, 0}), 1U);
  EXPECT_EQ(degenerate({0, 1, 1}), 0U);
  EXPECT_EQ(degenerate({1, 0, 0}), 2U);    // the closed ray meets the closed box
  EXPECT_EQ(degenerate({1.1, 0, 0}), 0U);  // behind
  EXPECT_EQ(degenerate({0, 5, 0}), 0U);    // on the line of an edge, beyond the box
}

// --- Near exterior edges ---

TEST(WindingNumber, NearExteriorEdgesKeepsTwelveDigits) {
  const TriangleMesh mesh = test::moved(test::open_box(), {1, 1, 1}, {0, 0, -1});  // the open side in the plane z = 0
  Random random(13);
  std::vector<Vec3> queries;
  for (int i = 0; i < 300; ++i) {
    const double distance = std::pow(10.0, -test::uniform(random, 1, 13)), angle = test::uniform(random, -3.1, 3.1);
    const double along = test::uniform(random, 0.1, 0.9);
    queries.push_back({along, distance * std::cos(angle), distance * std::sin(angle)});
    queries.push_back({distance * std::cos(angle), along, distance * std::sin(angle)});
  }
  EXPECT_LT(largest_error(mesh, queries), 1e-12);
}

TEST(WindingNumber, FarCloserToAnEdgeDependsOnTheDirectionOnly) {
  const TriangleMesh mesh = test::moved(test::open_box(), {1, 1, 1}, {0, 0, -1});
  for (const double angle : {0.3, 1.2, 2.5, -0.2, -1.5, -2.9}) {
    const auto at = [&](double distance) {
      return values_of(mesh, {{distance * std::cos(angle), 0.3, distance * std::sin(angle)}})[0];
    };
    const double limit = at(1e-20);
    for (const double distance : {1e-30, 1e-60, 1e-150, 1e-300}) EXPECT_NEAR(at(distance), limit, 1e-12) << distance;
  }
}

TEST(WindingNumber, PlainDoublesWouldLoseTheDigitsNearEdges) {  // negative control
  const Vec3 a{0, 0, 0}, b{0, 1, 0}, q{1e-10, 0.3, 1e-10};
  const auto argument = [&]<class Real>(Real) {
    const Real ax = Real(a.x) - q.x, ay = Real(a.y) - q.y, az = Real(a.z) - q.z;
    const Real bx = Real(b.x) - q.x, by = Real(b.y) - q.y, bz = Real(b.z) - q.z;
    const Real sa = std::sqrt(ax * ax + ay * ay + az * az) - ax, sb = std::sqrt(bx * bx + by * by + bz * bz) - bx;
    return static_cast<double>(std::atan2(ay * bz - az * by, sa * sb + ay * by + az * bz));
  };
  EXPECT_GT(std::abs(argument(1.0) - argument(1.0L)), 1e-9);
}

// D computed from the farther end of an edge loses its digits where the nearer one is level with the query.
TEST(WindingNumber, NearlyLevelWithAVertexKeepsTwelveDigits) {
  Random random(19);
  const TriangleMesh mesh = test::joined(test::open_box(), weld(test::soup(random, 10), {}));
  std::vector<Vec3> queries;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      const Vec3& p = mesh.vertices[v];
      const double step = std::pow(10.0, -test::uniform(random, 3, 15));
      queries.push_back({test::uniform(random, -1, 1.5), p.y + step, p.z - 0.3 * step});
    }
  }
  EXPECT_LT(largest_error(mesh, queries), kRounding);
}

// --- Magnitudes ---

TEST(WindingNumber, FarFromTheOriginIsTheDirectSum) {
  Random random(14);
  const Vec3 utm{5e5, 4.6e6, 120};
  const TriangleMesh mesh = test::moved(test::open_box(), {1, 1, 1}, utm);
  EXPECT_LT(largest_error(mesh, random_queries(random, {utm - Vec3{1, 1, 1}, utm + Vec3{2, 2, 2}}, 500)), kRounding);
}

TEST(WindingNumber, OfAnisotropicMeshesIsTheDirectSum) {
  Random random(15);
  for (const Vec3& factors : {Vec3{1e7, 1, 1}, Vec3{1, 1e7, 1}, Vec3{1, 1, 1e7}, Vec3{1e-7, 1, 1}}) {
    const TriangleMesh mesh = test::moved(test::open_box(), factors, {});
    EXPECT_LT(largest_error(mesh, random_queries(random, {-0.5 * factors, 1.5 * factors}, 300)), kRounding);
  }
}

TEST(WindingNumber, VanishesFarAwayAndStaysFiniteAtTheEndOfTheRange) {
  const TriangleMesh mesh = test::open_box();
  std::vector<Vec3> queries;
  for (const double far : {1e15, 1e30, 1e150, 1e300, 1.7e308}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double direction : {-1.0, 1.0}) {
        Vec3 q{0.3, 0.4, 0.6};
        q[axis] = direction * far;
        queries.push_back(q);
      }
    }
    queries.push_back({far, -far, far});
  }
  for (const double w : values_of(mesh, queries)) EXPECT_NEAR(w, 0.0, 1e-15);
}

TEST(WindingNumber, MinuteAndHugeMeshesKeepTheirValues) {
  Random random(16);
  const std::vector<Vec3> queries = random_queries(random, kAroundUnitCube, 100);
  const std::vector<double> expected = values_of(test::open_box(), queries);
  for (const double scale : {1e-300, 1e-120, 1e-30, 1e30, 1e120, 1e300}) {
    std::vector<Vec3> scaled;
    for (const Vec3& q : queries) scaled.push_back(scale * q);
    // Scaling by a power of ten rounds the queries: 1e-12 covers what that moves, at 1e-3 from edges or farther.
    EXPECT_LT(largest_difference(values_of(test::moved(test::open_box(), {scale, scale, scale}, {}), scaled), expected),
              1e-12)
        << scale;
  }
}

// --- Lattices and threads ---

TEST(WindingNumber, OnLatticesEqualsThatAtTheirPointsToTheBit) {
  Random random(17);
  const TriangleMesh mesh = test::joined(test::open_box(), test::lattice_soup(random, 12, 2));
  const Lattice lattice{{0.1, 0, -0.25}, {0.125, 0.25, 0.17}, {-3, -2, 0}, {70, 9, 7}};
  const std::vector<Vec3> points = test::samples_of(lattice);
  const WindingNumberEvaluator evaluator(mesh);
  std::vector<double> at_points(points.size()), on_lattice(points.size());
  const Tally a = evaluator.evaluate(points, at_points);
  std::atomic<std::uint64_t> done = 0;
  const Tally b = evaluator.evaluate(lattice, whole(lattice), on_lattice, &done);
  EXPECT_EQ(at_points, on_lattice);
  EXPECT_EQ(a.degenerate, b.degenerate);
  EXPECT_EQ(a.on_surface, b.on_surface);
  EXPECT_GT(a.degenerate, 0U);
  EXPECT_EQ(done, points.size());

  // Any block holds the values that the whole has there.
  const LatticeBlock block{{5, -1, 2}, {20, 3, 4}};
  std::vector<double> part(static_cast<std::size_t>(block.size()));
  evaluator.evaluate(lattice, block, part);
  EXPECT_EQ(part[0], on_lattice[static_cast<std::size_t>((2 * 9 + 1) * 70 + 8)]);
  EXPECT_EQ(part.back(), on_lattice[static_cast<std::size_t>((5 * 9 + 3) * 70 + 27)]);
}

// Lattices through the vertices of degenerate meshes, a lattice that misses them, and one that is a single column.
TEST(WindingNumber, EnginesAgreeToTheBit) {
  Random random(20);
  for (int i = 0; i < 12; ++i) {
    const TriangleMesh mesh = i % 3 == 0   ? test::random_cells(random, 3)
                              : i % 3 == 1 ? test::lattice_soup(random, 30, 3)
                                           : test::joined(test::sphere(6), test::fan(5, 3));
    const WindingNumberEvaluator scan(mesh), embree(mesh, {.ray_engine = RayEngine::kEmbree});
    for (const Lattice& lattice : {Lattice{{-1, -1, -1}, {0.25, 0.5, 0.5}, {0, 0, 0}, {21, 11, 11}},
                                   Lattice{{-0.7, 0.1, 0.2}, {0.173, 0.31, 0.37}, {-2, 0, 1}, {25, 9, 8}},
                                   Lattice{{0, 1, 1}, {0.5, 0.5, 0.5}, {-3, 0, 0}, {15, 1, 1}},
                                   Lattice{{1, 0, 0}, {0.5, 0.5, 0.5}, {0, 0, 0}, {1, 7, 7}}}) {
      const auto size = static_cast<std::size_t>(whole(lattice).size());
      std::vector<double> a(size), b(size);
      const Tally of_scan = scan.evaluate(lattice, whole(lattice), a);
      const Tally of_embree = embree.evaluate(lattice, whole(lattice), b);
      EXPECT_EQ(a, b);
      EXPECT_EQ(of_scan.degenerate, of_embree.degenerate);
      EXPECT_EQ(of_scan.on_surface, of_embree.on_surface);
    }
  }
}

TEST(WindingNumber, DoesNotDependOnThreads) {
  Random random(18);
  const TriangleMesh mesh = weld(test::soup(random, 50), {});
  const std::vector<Vec3> queries = random_queries(random, kAroundUnitCube, 5000);
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    results.push_back(values_of(mesh, queries));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// On the plane of the opening w is a half, and values next to it are settled.
TEST(WindingNumber, UnsettledIsTheSameButNextToHalfIntegers) {
  Random random(31);
  const TriangleMesh mesh = test::open_box();
  const Box box = bounding_box(mesh);
  std::vector<Vec3> queries = random_queries(random, box, 500);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {box.lower[axis], box.upper[axis]}) {
      for (int i = 0; i < 50; ++i) {
        queries.push_back(test::uniform_point(random, box));
        queries.back()[axis] = at + (i % 5) * 1e-16;
      }
    }
  }
  const WindingNumberEvaluator evaluator(mesh);
  const std::vector<double> settled = values_of(mesh, queries);
  std::vector<double> unsettled(queries.size());
  evaluator.evaluate_unsettled(queries, unsettled);
  int near = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const bool is_near = std::abs(settled[i] - std::floor(settled[i]) - 0.5) <= 2 * evaluator.doubt();
    near += is_near ? 1 : 0;
    if (is_near) {
      EXPECT_NEAR(unsettled[i], settled[i], 2 * evaluator.doubt());
    } else {
      EXPECT_EQ(unsettled[i], settled[i]);
    }
  }
  EXPECT_GT(near, 20);
}

TEST(WindingNumber, CallersFlushToZeroDoesNotMatter) {
  const double tiny = 1e-160;
  const TriangleMesh mesh = test::moved(test::open_box(), {tiny, tiny, tiny}, {});
  const std::vector<Vec3> queries{{0.3 * tiny, 0.3 * tiny, 0.5 * tiny}, {0.3 * tiny, 0.5 * tiny, 1.5 * tiny}};
  const std::vector<double> expected = values_of(mesh, queries);
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);
  const std::vector<double> flushed = values_of(mesh, queries);
  _mm_setcsr(before);
  EXPECT_EQ(flushed, expected);
}

}  // namespace
}  // namespace raycone
