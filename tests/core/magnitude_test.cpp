// Values are right at every magnitude of mesh and query, and at every distance from the surface.
#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>

#include "core/evaluation/winding_number.h"
#include "core/exact/predicates.h"
#include "core/exact/scale.h"
#include "core/machine/floating_point.h"
#include "core/mesh/weld.h"
#include "tests/property/check.h"
#include "tests/support/diagnosed.h"
#include "tests/support/lattice_samples.h"
#include "tests/support/shapes.h"
#include "tests/support/values.h"

namespace raycone {
namespace {

using test::Random;

constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expect_right(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  const auto failure = test::check(mesh, queries);
  EXPECT_FALSE(failure) << test::describe(mesh, *failure);
}

WindingNumberEvaluator by_embree(const TriangleMesh& mesh) {
  return WindingNumberEvaluator(mesh, {.ray_engine = RayEngine::kEmbree});
}

bool on_surface(const TriangleMesh& mesh, const Vec3& q) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return on_triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], q);
  });
}

// Between vertices, level with them, one unit in the last place beside that, and next to faces.
std::vector<Vec3> queries_beside(const TriangleMesh& mesh, Random& random, int count) {
  const Box box = bounding_box(mesh);
  const auto vertex = [&] { return mesh.vertices[mesh.triangles[random() % mesh.triangles.size()][random() % 3]]; };
  std::vector<Vec3> queries;
  for (int i = 0; i < count; ++i) {
    queries.push_back(test::uniform_point(random, box));
    Vec3 level{vertex().x, vertex().y, vertex().z};
    queries.push_back(level);
    const int axis = static_cast<int>(random() % 3);
    level[axis] = std::nextafter(level[axis], random() % 2 == 0 ? kInfinity : -kInfinity);
    queries.push_back(level);
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    Vec3 beside = 0.25 * mesh.vertices[t[0]] + 0.5 * mesh.vertices[t[1]] + 0.25 * mesh.vertices[t[2]];
    queries.push_back(beside);
    beside[axis] = std::nextafter(beside[axis], random() % 2 == 0 ? kInfinity : -kInfinity);
    queries.push_back(beside);
  }
  return queries;
}

// A closed mesh, an open one, and unrelated triangles with many ties.
std::vector<TriangleMesh> samples_of_meshes(Random& random) {
  return {test::random_cells(random, 2), test::sphere(4), test::open_box(), test::lattice_soup(random, 12, 3),
          weld(test::soup(random, 8), {})};
}

TEST(Magnitude, FarFromTheOriginAsInUtmCoordinates) {
  Random random(1);
  const Vec3 shift{5e5, 4.6e6, 120.7};
  for (const double size : {1e-3, 1.0, 300.0}) {
    for (const TriangleMesh& mesh : samples_of_meshes(random)) {
      const TriangleMesh there = weld(test::moved(mesh, {size, size, size}, shift), {});
      expect_right(there, queries_beside(there, random, 20));
    }
  }
}

TEST(Magnitude, OfMinuteAndHugeMeshes) {
  Random random(2);
  for (const double size : {1e-300, 1e-120, 1e120, 1e300}) {
    for (const TriangleMesh& mesh : samples_of_meshes(random)) {
      const TriangleMesh scaled = weld(test::moved(mesh, {size, size, size}, {}), {});
      expect_right(scaled, queries_beside(scaled, random, 20));
    }
  }
}

double of_any_magnitude(Random& random, double exponent) {
  return test::uniform(random, -1, 1) * std::exp2(std::round(test::uniform(random, -exponent, exponent)));
}

// Each coordinate has a magnitude of its own. Off the surface: no actual step of a query is below all such magnitudes.
TEST(Magnitude, MixedWithinOneMesh) {
  Random random(3);
  const DefaultFloatingPoint guard;
  for (const double exponent : {30.0, 200.0, 450.0, 900.0}) {
    for (int i = 0; i < 20; ++i) {
      TriangleMesh mesh = test::soup(random, 1 + i % 4);
      for (Vec3& v : mesh.vertices) {
        for (int axis = 0; axis < 3; ++axis) v[axis] = of_any_magnitude(random, exponent);
      }
      std::vector<Vec3> queries = queries_beside(mesh, random, 10);
      std::erase_if(queries, [&](const Vec3& q) { return on_surface(mesh, q); });
      expect_right(mesh, queries);
    }
  }
}

// A mesh of size 1 about the origin within one of size 2^1000, which no scaling brings into one range.
TEST(Magnitude, OfASmallBoxInsideAHugeOne) {
  for (const double small : {1.0, 0x1p-300, 0x1p-1000}) {
    const double huge = 0x1p1000;
    const Vec3 one{1, 1, 1};
    const TriangleMesh mesh =
        test::joined(test::box_mesh(-small * one, small * one), test::box_mesh(-huge * one, huge * one));
    std::vector<Vec3> queries;
    std::vector<double> expected;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const auto add = [&](double x, double w) {
          Vec3 q{0.25 * small, 0.125 * small, -0.375 * small};
          q[axis] = side * x;
          queries.push_back(q);
          expected.push_back(w);
        };
        add(0.5 * small, 2);
        add(std::nextafter(small, 0), 2);
        add(std::nextafter(small, huge), 1);
        add(std::nextafter(huge, 0), 1);
        add(std::nextafter(huge, kInfinity), 0);
      }
    }
    std::vector<double> values(queries.size());
    EXPECT_EQ(WindingNumberEvaluator(mesh).evaluate(queries, values).on_surface, 0U);
    EXPECT_EQ(values, expected) << small;
    expect_right(mesh, queries);
  }
}

TEST(Magnitude, OfFlatMeshes) {
  Random random(4);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double level : {0.0, 1.0, 1e-300, 4.6e6}) {
      Vec3 factors{1, 1, 1}, shift;
      factors[axis] = 0;
      shift[axis] = level;
      const TriangleMesh mesh = weld(test::moved(test::lattice_soup(random, 15, 3), factors, shift), {});
      std::vector<Vec3> queries = queries_beside(mesh, random, 20);
      for (const Vec3& q : std::vector<Vec3>(queries)) {
        for (const double distance : {-1.0, 1e-200, 0.3}) {
          queries.push_back(q);
          queries.back()[axis] += distance;
        }
      }
      expect_right(mesh, queries);
    }
  }
}

// A rotation by Euler angles; what it rounds is part of the mesh.
TriangleMesh rotated(TriangleMesh mesh, Random& random) {
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = test::uniform(random, -3, 3), c = std::cos(angle), s = std::sin(angle);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (Vec3& p : mesh.vertices) {
      const double pu = p[u], pv = p[v];
      p[u] = c * pu - s * pv;
      p[v] = s * pu + c * pv;
    }
  }
  return mesh;
}

TEST(Magnitude, AnisotropicAndRotated) {
  Random random(5);
  for (const Vec3& factors : {Vec3{1e7, 1, 1}, Vec3{1, 1e7, 1}, Vec3{1, 1, 1e7}, Vec3{1, 1e-7, 1e7}}) {
    for (const TriangleMesh& mesh : samples_of_meshes(random)) {
      const TriangleMesh stretched = test::moved(mesh, factors, {});
      expect_right(stretched, queries_beside(stretched, random, 10));
      const TriangleMesh oblique = weld(rotated(stretched, random), {});
      expect_right(oblique, queries_beside(oblique, random, 10));
    }
  }
}

// At a distance of R sizes an open mesh has a value of some R^-2, far below what rounding leaves: what is promised, and
// checked, is the error bound.
TEST(Magnitude, OfQueriesFarAway) {
  Random random(6);
  for (const TriangleMesh& mesh : samples_of_meshes(random)) {
    const Box box = bounding_box(mesh);
    std::vector<Vec3> queries;
    for (const double distance : {1e3, 1e8, 1e15, 1e30, 1e100}) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          queries.push_back(test::uniform_point(random, box));  // the ray may hit, in +x
          queries.back()[axis] += side * distance;
          queries.push_back(mesh.vertices[mesh.triangles[0][0]]);
          queries.back()[axis] += side * distance;
          queries.push_back(distance * test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}}));
        }
      }
    }
    expect_right(mesh, queries);
    const std::vector<double> values = test::values_of(WindingNumberEvaluator(mesh), queries);
    for (std::size_t i = 0; i < values.size(); ++i) {
      // Some unit cells of the mesh, each seen under at most 1 / 4 pi R^2 turns, R at least 990; and rounding.
      EXPECT_NEAR(values[i], 0, 1e-5) << queries[i].x << " " << queries[i].y << " " << queries[i].z;
    }
  }
}

// A mesh far smaller than what scaling can bring the query to.
TEST(Magnitude, OfQueriesFarFromMinuteMeshes) {
  for (const double size : {1e-300, 1e-120}) {
    const TriangleMesh open = test::moved(test::open_box(), {size, size, size}, {});
    const TriangleMesh closed = test::moved(test::box_mesh({0, 0, 0}, {1, 1, 1}), {size, size, size}, {});
    for (const double distance : {1e-100, 1.0, 1e100, kLargest}) {
      std::vector<Vec3> queries;
      for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
          Vec3 q{0.3 * size, 0.4 * size, 0.6 * size};
          q[axis] = side * distance;
          queries.push_back(q);
        }
      }
      queries.push_back({distance, -distance, distance});
      EXPECT_EQ(test::values_of(WindingNumberEvaluator(closed), queries), std::vector<double>(queries.size(), 0.0));
      for (const double w : test::values_of(WindingNumberEvaluator(open), queries))
        EXPECT_NEAR(w, 0, 1e-15);  // rounding; NaN fails
    }
  }
}

// Around and before a triangle of size 2^-450 or 2^-900, at distance 1 from the query: squares of its size underflow.
TEST(Magnitude, OfTinyTrianglesFarAhead) {
  Random random(10);
  for (const double size : {0x1p-200, 0x1p-390, 0x1p-410, 0x1p-450, 0x1p-540, 0x1p-900}) {
    TriangleMesh mesh = test::soup(random, 3);
    for (Vec3& v : mesh.vertices) v = {v.x, size * (v.y - 0.5), size * (v.z - 0.5)};
    std::vector<Vec3> queries;
    for (int i = 0; i < 60; ++i) {
      const Vec3 q = test::uniform_point(random, {{-1, -0.5, -0.5}, {1, 0.5, 0.5}});
      queries.push_back({q.x, size * q.y, size * q.z});
      queries.push_back({q.x - 2, size * q.y, size * q.z});
    }
    expect_right(mesh, queries);
    mesh.vertices.insert(mesh.vertices.end(), {{0.5, 0.5, 0.5}, {0.5, 0.5, 1}, {0.5, 1, 1}});
    mesh.triangles.push_back({9, 10, 11});  // keeps the scale at 1
    expect_right(mesh, queries);
  }
}

// --- As close to a surface as doubles get ---

struct Near {
  std::vector<Vec3> queries;
  std::vector<double> expected;
};

// Beside the middle of each face of a box, `steps` doubles off.
Near beside_faces(const Vec3& lower, const Vec3& upper, int steps) {
  Near near;
  const Vec3 middle = 0.5 * lower + 0.5 * upper;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double face : {lower[axis], upper[axis]}) {
      for (const double towards : {-kInfinity, kInfinity}) {
        Vec3 q = middle;
        q[axis] = face;
        for (int i = 0; i < steps; ++i) q[axis] = std::nextafter(q[axis], towards);
        near.queries.push_back(q);
        near.expected.push_back((face == lower[axis]) == (towards > 0) ? 1.0 : 0.0);
      }
    }
  }
  return near;
}

TEST(Magnitude, OneUnitInTheLastPlaceTellsInsideFromOutside) {
  const std::vector<Box> boxes{
      {{0, 0, 0}, {1, 1, 1}},
      {{0.1, 0.2, 0.3}, {0.7, 0.9, 1.1}},
      {{5e5, 4.6e6, 120.7}, {5e5 + 3, 4.6e6 + 1, 121}},
      {{-1e-120, 0, 1e-121}, {0, 1e-120, 3e-120}},
      {{-1e120, 0, 1e119}, {0, 1e120, 3e120}},
      {{-1e-307, 0, 0}, {0, 1e-307, 3e-308}},
      {{-1e307, 0, 1e306}, {0, 1e307, 1e308}},
  };
  for (const auto& [lower, upper] : boxes) {
    const TriangleMesh mesh = test::box_mesh(lower, upper);
    for (const int steps : {1, 2, 7}) {
      const auto [queries, expected] = beside_faces(lower, upper, steps);
      std::vector<double> values(queries.size());
      EXPECT_EQ(WindingNumberEvaluator(mesh).evaluate(queries, values).on_surface, 0U);
      EXPECT_EQ(values, expected) << lower.x << " " << lower.y << " " << lower.z;
      expect_right(mesh, queries);
    }
    const auto [queries, expected] = beside_faces(lower, upper, 0);  // negative control
    std::vector<double> values(queries.size());
    EXPECT_EQ(WindingNumberEvaluator(mesh).evaluate(queries, values).on_surface, queries.size());
  }
}

// A tetrahedron with a face through the origin, whose normal is neither parallel to an axis nor to a diagonal.
TriangleMesh tetrahedron_at_origin(double size) {
  const double s = size;
  const Vec3 a{2 * s, -s, 0}, b{-3 * s, 0, s}, c{s, s, -s}, apex{s, 2 * s, 3 * s};
  return {{a, b, c, apex}, {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
}

TEST(Magnitude, TheSmallestNumberTellsTheSideOfAnObliqueFace) {
  for (const double size : {0x1p-1000, 0x1p-10, 1.0, 0x1p500, 0x1p1000}) {
    const TriangleMesh mesh = tetrahedron_at_origin(size);
    std::vector<Vec3> queries;
    std::vector<double> expected;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double distance : {kSmallest, 3 * kSmallest, 1e-310, 0x1p-1003}) {
        for (const double side : {-1.0, 1.0}) {
          Vec3 q{0, 0, 0};
          q[axis] = side * distance;
          queries.push_back(q);
          expected.push_back(side > 0 ? 1.0 : 0.0);
        }
      }
      // x + 2 y + 3 z is the smallest number, from terms that are larger.
      queries.push_back({6 * kSmallest, kSmallest * -1, -1 * kSmallest});
      expected.push_back(1.0);
      queries.push_back({4 * kSmallest, kSmallest * -1, -1 * kSmallest});
      expected.push_back(0.0);
    }
    std::vector<double> values(queries.size());
    EXPECT_EQ(WindingNumberEvaluator(mesh).evaluate(queries, values).on_surface, 0U) << size;
    EXPECT_EQ(values, expected) << size;
    expect_right(mesh, queries);
    // Negative control: exactly on the face.
    const std::vector<Vec3> on_face{{0, 0, 0}, {5 * kSmallest, -kSmallest, -kSmallest}};
    values.resize(on_face.size());
    EXPECT_EQ(WindingNumberEvaluator(mesh).evaluate(on_face, values).on_surface, on_face.size()) << size;
  }
}

// The nearest doubles on both sides of faces in general position, found by the exact predicate.
TEST(Magnitude, NeighbouringDoublesOnBothSidesOfObliqueFacesAreRight) {
  Random random(7);
  const DefaultFloatingPoint guard;
  for (const double size : {1e-305, 1e-120, 1.0, 1e120, 1e305}) {
    const TriangleMesh mesh = test::moved(rotated(test::sphere(4), random), {size, size, size}, {0, size, 0});
    std::vector<Vec3> queries;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 q = 0.25 * a + 0.5 * b + 0.25 * c;
        const int side = plane_side(a, b, c, q);
        const double towards =
            plane_side(a, b, c, {axis == 0 ? kLargest : 0, axis == 1 ? kLargest : 0, axis == 2 ? kLargest : 0}) == side
                ? -kInfinity
                : kInfinity;
        for (int i = 0; i < 200 && plane_side(a, b, c, q) == side; ++i) {
          queries.push_back(q);
          if (i > 0) queries.erase(queries.end() - 2);  // the last one before the plane
          q[axis] = std::nextafter(q[axis], towards);
        }
        queries.push_back(q);
      }
    }
    expect_right(mesh, queries);
  }
}

// Rays that pass an edge ahead as closely as rounding allows: where floating point has the sign of D wrong, crossings
// and cone must still jump together.
TEST(Magnitude, RaysWithinRoundingOfAnEdgeAreRight) {
  Random random(11);
  const DefaultFloatingPoint guard;
  int misjudged = 0;
  for (int i = 0; i < 500; ++i) {
    TriangleMesh mesh = test::soup(random, 1);
    for (Vec3& v : mesh.vertices) {  // magnitudes differ, so that differences are rounded
      for (int axis = 0; axis < 3; ++axis) v[axis] = std::ldexp(v[axis], -static_cast<int>(random() % 8));
    }
    const Vec3 &a = mesh.vertices[0], &b = mesh.vertices[1];
    std::vector<Vec3> queries;
    for (int j = 0; j < 20; ++j) {
      const double t = test::uniform(random, 0, 1);
      Vec3 q{-1, a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
      if (random() % 2 == 0) q.y = std::nextafter(q.y, random() % 2 == 0 ? 2 : -2);
      queries.push_back(q);
      const double floating_point = edge_determinant(a, b, q).value;
      misjudged += floating_point * exact_edge_orientation(a, b, q) < 0;
    }
    expect_right(mesh, queries);
  }
  EXPECT_GT(misjudged, 50);  // else nothing has been tested
}

// Candidates of a ray are found in float: a triangle that the ray misses by less than floats can tell is one of them.
TEST(Magnitude, TiesWithTrianglesThatTheRayBarelyMissesDoNotCount) {
  const TriangleMesh mesh{{{1, 0, 0}, {1, 4, 0}, {1, 0, 4}}, {{0, 1, 2}}};
  const double step = 1e-9;
  for (const RayEngine engine : {RayEngine::kScan, RayEngine::kEmbree}) {
    const auto ties = [&](const Vec3& q) {
      double value = 0;
      return WindingNumberEvaluator(mesh, {.ray_engine = engine}).evaluate({&q, 1}, {&value, 1}).degenerate;
    };
    EXPECT_EQ(ties({0, 4, 0}), 2U);
    EXPECT_EQ(ties({0, 4 + step, 0}), 0U);
    EXPECT_EQ(ties({0, -step, 0}), 0U);
    EXPECT_EQ(ties({0, 0, 4 + step}), 0U);
    EXPECT_EQ(ties({0, 0, -step}), 0U);
    EXPECT_EQ(ties({1 + step, 4, 0}), 0U);
  }
}

TEST(Magnitude, CallersFlushToZeroDoesNotMatterForSubnormalQueries) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<Vec3> queries{{0.5, 0.5, -kSmallest}, {0.5, -kSmallest, 0.5}, {-kSmallest, 0.5, 0.5},
                                  {0.5, 0.5, kSmallest},  {0.5, kSmallest, 0.5},  {kSmallest, 0.5, 0.5}};
  std::vector<double> values(queries.size());
  Tally tally;
  std::thread caller([&] {  // a new thread: TBB hands its environment on to tasks as it was at first use
    _mm_setcsr(_mm_getcsr() | 0x8040U);
    tally = WindingNumberEvaluator(mesh).evaluate(queries, values);
  });
  caller.join();
  EXPECT_EQ(tally.on_surface, 0U);
  EXPECT_EQ(values, (std::vector<double>{0, 0, 0, 1, 1, 1}));
}

// --- The ends of the range ---

// Coordinates that no scaled double holds, against a mesh of the other end of the range.
// Far away factors are large, and edges level with a ray have none: a tile of one ray knows that beforehand.
TEST(Magnitude, FarPointsHaveTheSameValuesAloneAsAmongOthers) {
  Random random(12);
  int ties = 0, values_of_open_meshes = 0;
  for (const TriangleMesh& mesh : {test::lattice_soup(random, 30, 3), test::open_box(), test::fan(24, 5)}) {
    std::vector<Vec3> queries;
    for (int i = 0; i < 200; ++i) {
      const double far = std::ldexp(1.0, static_cast<int>(random() % 130));
      Vec3 q = test::uniform_point(random, {{-far, -far, -far}, {far, far, far}});
      const Vec3& level = mesh.vertices[random() % mesh.vertices.size()];
      if (i % 4 != 0) q[1 + i % 2] = level[1 + i % 2];
      queries.push_back(q);
    }
    for (const EvaluatorOptions& options :
         {EvaluatorOptions{.level = SimdLevel::kSse4, .summation = Summation::kCone},
          EvaluatorOptions{.summation = Summation::kCone}, EvaluatorOptions{.summation = Summation::kTriangles}}) {
      const WindingNumberEvaluator evaluator(mesh, options);
      std::vector<double> values(queries.size());
      ties += evaluator.evaluate(queries, values).degenerate > 0 ? 1 : 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        double alone = 0;
        evaluator.evaluate({&queries[i], 1}, {&alone, 1});
        EXPECT_EQ(alone, values[i]) << i;
        values_of_open_meshes += alone != std::round(alone) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(ties, 2);
  EXPECT_GT(values_of_open_meshes, 500);
}

TEST(Magnitude, SubnormalQueriesOfHugeMeshes) {
  Random random(8);
  for (const double size : {1.0, 0x1p100, 0x1p900, 0x1p1023}) {
    for (const TriangleMesh& unit : samples_of_meshes(random)) {
      const TriangleMesh mesh = test::moved(unit, {size / 4, size / 4, size / 4}, {});
      std::vector<Vec3> queries;
      for (int i = 0; i < 40; ++i) {
        Vec3 q;
        for (int axis = 0; axis < 3; ++axis) {
          const double fraction = static_cast<double>(random() % 7) / 8;
          q[axis] = random() % 2 == 0 ? fraction * size
                                      : static_cast<double>(random() % 7) * kSmallest * (random() % 2 == 0 ? -1 : 1);
        }
        queries.push_back(q);
      }
      expect_right(mesh, queries);
    }
  }
}

TEST(Magnitude, AtTheLargestNumberEveryValueIsRight) {
  const double l = kLargest;
  const std::array<double, 9> coordinates{0, kSmallest, -kSmallest, 0x1p-1022, 1, -1, l / 2, l, -l};
  std::vector<Vec3> queries;
  for (const double x : coordinates) {
    for (const double y : coordinates) {
      for (const double z : coordinates) queries.push_back({x, y, z});
    }
  }
  const TriangleMesh whole = test::box_mesh({-l, -l, -l}, {l, l, l});
  const TriangleMesh part = test::box_mesh({-l / 2, 0, 0}, {l, l / 2, l});
  const std::vector<double> of_whole = test::values_of(WindingNumberEvaluator(whole), queries),
                            of_part = test::values_of(WindingNumberEvaluator(part), queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Vec3& q = queries[i];
    EXPECT_EQ(of_whole[i], q.x < l && q.y < l && q.z < l ? 1.0 : 0.0) << q.x << " " << q.y << " " << q.z;
    const bool inside = q.x >= -l / 2 && q.x < l && q.y >= 0 && q.y < l / 2 && q.z >= 0 && q.z < l;
    EXPECT_EQ(of_part[i], inside ? 1.0 : 0.0) << q.x << " " << q.y << " " << q.z;
  }
  TriangleMesh open = whole;
  open.triangles.resize(7);
  for (const TriangleMesh& mesh : {open, test::moved(test::open_box(), {l, l, l}, {}), test::open_box()}) {
    const test::Diagnosed found = test::diagnosed(WindingNumberEvaluator(mesh), queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {  // NaN fails both
      EXPECT_LE(std::abs(found.values[i]), 1.0) << queries[i].x << " " << queries[i].y << " " << queries[i].z;
      EXPECT_LT(found.bounds[i], 1e-12) << queries[i].x << " " << queries[i].y << " " << queries[i].z;
    }
  }
}

// --- Lattices ---

TEST(Magnitude, OfLatticesEqualsThatOfPointsToTheBit) {
  Random random(9);
  for (const double size : {0x1p-1060, 1e-300, 1e-120, 1.0, 1e120, 1e300}) {
    for (const TriangleMesh& unit : samples_of_meshes(random)) {
      for (const Vec3& anisotropy : {Vec3{1, 1, 1}, Vec3{1e-7, 1, 1}, Vec3{1e7, 1, 1e-7}}) {
        const Vec3 factors = size * anisotropy;
        const TriangleMesh mesh = weld(test::moved(unit, factors, {}), {});
        const Lattice lattice{-0.5 * factors, 0.25 * factors, {0, 0, 0}, {17, 9, 9}};
        const std::vector<Vec3> points = test::samples_of(lattice);
        std::vector<double> at_points(points.size()), on_lattice(points.size());
        const WindingNumberEvaluator evaluator(mesh);
        const Tally a = evaluator.evaluate(points, at_points),
                    b = evaluator.evaluate(lattice, whole(lattice), on_lattice);
        EXPECT_EQ(at_points, on_lattice) << size;
        EXPECT_EQ(a.degenerate, b.degenerate);
        EXPECT_EQ(a.on_surface, b.on_surface);
      }
    }
  }
}

// Coordinates of all exponents in one mesh: products underflow, and large factors bring back what was lost. The lattice
// scan's filters against the predicates alone, which Embree's candidates are given to.
TEST(Magnitude, ScansAreRightWhereProductsUnderflow) {
  Random random(10);
  std::uint64_t inside = 0;
  const auto coordinate = [&](int lowest) {
    const std::array<int, 8> exponents{0, 0, -1, -50, lowest / 4, lowest / 2, lowest, lowest + 30};
    const std::uint64_t kind = random() % 4;
    if (kind == 0) return 0.0;
    const double mantissa = kind == 1 ? 1.0 : kind == 2 ? 1.5 : test::uniform(random, 0.5, 1.5);
    return std::ldexp(random() % 2 == 0 ? mantissa : -mantissa, exponents[random() % exponents.size()]);
  };
  for (int n = 0; n < 3000; ++n) {
    const int lowest = n % 3 == 0 ? -870 : n % 3 == 1 ? -450 : -1000, shift = n % 5 == 0 ? 1000 : 0;
    TriangleMesh mesh{{}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    for (int v = 0; v < 4; ++v) {
      mesh.vertices.push_back({coordinate(lowest), coordinate(lowest), coordinate(lowest)});
      for (int axis = 0; axis < 3; ++axis) mesh.vertices.back()[axis] = std::ldexp(mesh.vertices.back()[axis], shift);
    }
    std::array<Vec3, 2> ends;
    for (Vec3& end : ends) {
      double all = 0.0;
      std::array<double, 4> weights;
      for (double& weight : weights) all += weight = std::pow(test::uniform(random, 0.0, 1.0), 3);
      for (std::size_t v = 0; v < 4; ++v) end = end + (weights[v] / all) * mesh.vertices[v];
    }
    const Box box = box_of(ends[0], ends[1]);
    const Lattice lattice{box.lower, 0.125 * (box.upper - box.lower), {0, 0, 0}, {9, 9, 9}};
    if (!(lattice.spacing.x > 0.0 && lattice.spacing.y > 0.0 && lattice.spacing.z > 0.0)) continue;
    const std::vector<double> scanned = test::values_of(WindingNumberEvaluator(mesh), lattice);
    const std::vector<double> expected = test::values_of(by_embree(mesh), lattice);
    ASSERT_EQ(scanned, expected) << n;
    inside += static_cast<std::uint64_t>(std::ranges::count_if(scanned, [](double w) { return w != 0.0; }));
  }
  EXPECT_GT(inside, 100'000U);  // else nothing has been tested
}

// A plane whose normal underflows in y, and is multiplied by much.
TEST(Magnitude, PlanesOfTrianglesWhoseNormalsUnderflow) {
  const double u = 0x1p-200, t = 0x1p-890;
  const TriangleMesh mesh{{{0, 0, 0}, {u, 1, 0}, {0, 0.5, t}, {1, 0.5, t / 4}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const Lattice lattice{{-u, 0.4, t / 4}, {2 * u / 15, 0.2 / 3, 0.35 / 3 * t}, {0, 0, 0}, {16, 4, 4}};
  const std::vector<double> scanned = test::values_of(WindingNumberEvaluator(mesh), lattice);
  const std::vector<double> expected = test::values_of(by_embree(mesh), lattice);
  EXPECT_EQ(scanned, expected);
}

// The slope of an edge in a mesh that cannot be scaled: it underflows, and is multiplied by much.
TEST(Magnitude, EdgesWhoseSlopesUnderflow) {
  const double h = 0x1p999, y = 1.1 * 0x1p-50, dy = 1.2345678901 * 0x1p-50;
  const TriangleMesh mesh{{{1, y, -h}, {1, y + dy, h}, {2, -1, 0}, {2, 1, 0}},
                          {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2}}};
  const double z = 0.3 * h, middle = y + 0.65 * dy;
  for (const double step : {0x1p-80, 0x1p-90, 0x1p-100}) {
    const Lattice lattice{{0, middle - 32 * step, z}, {0.125, step, 1}, {0, 0, 0}, {4, 64, 1}};
    const std::vector<double> scanned = test::values_of(WindingNumberEvaluator(mesh), lattice);
    const std::vector<double> expected = test::values_of(by_embree(mesh), lattice);
    EXPECT_EQ(scanned, expected) << step;
  }
}

// A cup of which one coordinate is so small that scaling the others down to 1 would lose it: squares of distances
// overflow. The oracle is the cup of size 1, where that coordinate makes no difference that the samples could tell.
TEST(Magnitude, SidesOfMeshesThatCannotBeScaled) {
  const double size = 0x1p515;
  TriangleMesh cup = test::sphere(12);
  std::erase_if(cup.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return cup.vertices[v].z < -0.1; });
  });
  TriangleMesh huge = test::moved(cup, {size, size, size}, {});
  for (Vec3& v : huge.vertices) {
    if (v.z == size) v.x = 1.1e-165;
  }
  EXPECT_EQ(unit_scale(huge).exponent(), 0);
  const Lattice lattice{{-0.3125, -0.3125, -0.8125}, {0.015625, 0.015625, 0.03125}, {0, 0, 0}, {37, 37, 33}};
  const Lattice huge_lattice{size * lattice.origin, size * lattice.spacing, {0, 0, 0}, lattice.counts};
  const std::vector<double> values = test::values_of(WindingNumberEvaluator(weld(cup, {})), lattice);
  std::vector<std::uint8_t> sides(values.size());
  const WindingNumberEvaluator evaluator(weld(huge, {}));
  EXPECT_GT(static_cast<double>(evaluator.exterior_edges() * values.size()), 0x1p20);  // else certificates do not pay
  evaluator.evaluate_sides({RuleKind::kThreshold, 0.3}, huge_lattice, whole(huge_lattice), sides);
  std::uint64_t inside = 0, wrong = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    inside += sides[i];
    if (std::abs(values[i] - 0.3) > 1e-12) wrong += sides[i] != static_cast<std::uint8_t>(values[i] > 0.3);
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(inside, 1000U);
  EXPECT_LT(inside, values.size() - 1000);
}

}  // namespace
}  // namespace raycone
