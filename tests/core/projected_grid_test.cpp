#include "core/crossings/projected_grid.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/crossings/binned_rays.h"
#include "core/crossings/crossings.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

struct Found {
  int n = 0;
  int ties = 0;
  bool on_surface = false;
  std::size_t decided = 0;  // triangles that exact predicates were asked about

  [[nodiscard]] bool same_as(const Found& other) const {
    return n == other.n && ties == other.ties && on_surface == other.on_surface;
  }

  void add(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& q) {
    const auto [a, b, c] = corners_of(mesh, mesh.triangles[triangle]);
    const QueryCrossing crossing = triangle_crossing(a, b, c, q);
    n += crossing.sigma;
    ties += crossing.ties;
    on_surface = on_surface || crossing.on_surface;
    ++decided;
  }
};

Found by_all_triangles(const TriangleMesh& mesh, const Vec3& q) {
  Found found;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) found.add(mesh, i, q);
  return found;
}

struct Totals {
  std::size_t crossed = 0, ties = 0, on_surface = 0, decided = 0, met = 0;
};

// What the grid finds, all queries at once.
std::vector<Found> by_grid(const ProjectedGrid& grid, const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  std::vector<std::int64_t> n(queries.size(), 99);
  std::vector<RayCandidate> doubtful;
  grid.crossings(queries, n, doubtful);
  std::vector<Found> found(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) found[i].n = static_cast<int>(n[i]);
  for (const auto& [i, triangle] : doubtful) found[i].add(mesh, triangle, queries[i]);
  return found;
}

// What a pass over the triangles finds.
std::vector<Found> by_pass(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  std::vector<NumberedRay> rays;
  for (std::uint32_t i = 0; i < queries.size(); ++i) rays.push_back({queries[i], i});
  const BinnedRays binned(rays);
  std::vector<Found> found(queries.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    binned.for_each_met(box_of(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]), [&](const NumberedRay& ray) {
      EXPECT_EQ(ray.origin, queries[ray.number]);
      found[ray.number].add(mesh, t, ray.origin);
    });
  }
  return found;
}

Totals check(const TriangleMesh& mesh, const std::vector<Vec3>& queries) {
  const DefaultFloatingPoint guard;
  const ProjectedGrid grid(mesh);
  const std::vector<Found> all_found = by_grid(grid, mesh, queries), found_by_pass = by_pass(mesh, queries);
  std::vector<ProjectedGrid::Place> places(queries.size());
  grid.find_places(queries, places);
  Totals totals;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Vec3& q = queries[i];
    const Found &found = all_found[i], expected = by_all_triangles(mesh, q);
    EXPECT_TRUE(found_by_pass[i].same_as(expected)) << "a pass at " << q.x << ' ' << q.y << ' ' << q.z;
    const bool same = found.same_as(expected);
    EXPECT_TRUE(same) << found.n << " for " << expected.n << ", ties " << found.ties << " for " << expected.ties
                      << " at " << q.x << ' ' << q.y << ' ' << q.z;
    if (!same) return totals;
    const bool any = expected.n != 0 || expected.ties != 0 || expected.on_surface;
    EXPECT_TRUE(places[i].may_meet || !any) << "not met at " << q.x << ' ' << q.y << ' ' << q.z;
    EXPECT_EQ(places[i].morton_code, grid.morton_code(q));
    totals.crossed += expected.n != 0 ? 1 : 0;
    totals.ties += static_cast<std::size_t>(expected.ties);
    totals.on_surface += expected.on_surface ? 1 : 0;
    totals.decided += found.decided;
    totals.met += places[i].may_meet ? 1 : 0;
  }
  return totals;
}

// Random points, vertices, middles of edges and points level with them, before, within and behind the mesh.
std::vector<Vec3> queries_about(const TriangleMesh& mesh, test::Random& random, std::size_t each) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  std::vector<Vec3> queries;
  for (std::size_t i = 0; i < each; ++i) {
    queries.push_back(test::uniform_point(random, {box.lower - 0.1 * size, box.upper + 0.1 * size}));
    const Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]];
    const Vec3 middle = 0.5 * (a + b), beyond = a + 1.5 * (b - a);
    for (Vec3 q : {a, middle, beyond}) {
      queries.push_back(q);
      q.x = test::uniform(random, box.lower.x - size.x, box.upper.x + size.x);
      queries.push_back(q);
    }
  }
  return queries;
}

TEST(ProjectedGrid, FindsWhatAllTrianglesSayOnDegenerateLattices) {
  test::Random random(1);
  for (const TriangleMesh& mesh : {test::random_cells(random, 8), test::lattice_soup(random, 400, 6)}) {
    std::vector<Vec3> queries;
    for (int j = 0; j <= 16; ++j) {
      for (int k = 0; k <= 16; ++k) queries.push_back({-1.0 + j % 5, 0.5 * j, 0.5 * k});
    }
    const Totals totals = check(mesh, queries);
    EXPECT_GT(totals.crossed, 30U);
    EXPECT_GT(totals.ties, 1000U);
    EXPECT_GT(totals.on_surface, 30U);
  }
}

// Needles along every direction, some of them edge-on to the rays: the lines of their edges leave them far behind.
TriangleMesh needles(test::Random& random, int count) {
  TriangleMesh mesh;
  const Box box{{0, 0, 0}, {1, 1, 1}};
  for (int i = 0; i < count; ++i) {
    const Vec3 a = test::uniform_point(random, box), b = test::uniform_point(random, box);
    const Vec3 c = i % 3 == 0 ? a + Vec3{0.5, 0, 0} : a + 1e-3 * (test::uniform_point(random, box) - a);
    test::add_triangle(mesh, a, b, c);
  }
  return mesh;
}

TEST(ProjectedGrid, FindsWhatAllTrianglesSayOfNeedlesLargeTrianglesAndFineParts) {
  test::Random random(2);
  const TriangleMesh fine = test::moved(test::sphere(12), {1e-4, 1e-4, 1e-4}, {0.3, 0.4, 0.5});
  const TriangleMesh finest = test::moved(test::sphere(6), {1e-9, 1e-9, 1e-9}, {0.3, 0.4, 0.5});
  const std::vector<TriangleMesh> meshes{needles(random, 600), test::soup(random, 300),
                                         test::joined(test::joined(test::soup(random, 50), fine), finest),
                                         test::fan(40, 25), test::open_box()};
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SCOPED_TRACE("mesh " + std::to_string(i));
    const Totals totals = check(meshes[i], queries_about(meshes[i], random, 120));
    EXPECT_GT(totals.ties, 50U);
  }
}

TEST(ProjectedGrid, FindsWhatAllTrianglesSayAtAnyMagnitude) {
  test::Random random(3);
  for (const auto& [factors, shift] : std::vector<std::array<Vec3, 2>>{{Vec3{1, 1, 1}, Vec3{5e5, 4.6e6, 120}},
                                                                       {Vec3{1, 1e7, 1e-7}, Vec3{3, 5, 4}},
                                                                       {Vec3{1e-300, 1e-300, 1e-300}, Vec3{0, 0, 0}},
                                                                       {Vec3{1e-310, 1e-300, 1e250}, Vec3{0, 0, 0}},
                                                                       {Vec3{1e300, 1e300, 1e300}, Vec3{0, 0, 0}},
                                                                       {Vec3{1, 1, 0}, Vec3{0, 0, 1}},
                                                                       {Vec3{0, 0, 0}, Vec3{1, 2, 3}}}) {
    SCOPED_TRACE(std::to_string(std::log10(factors.y)) + " at " + std::to_string(shift.y));
    const TriangleMesh mesh = test::moved(test::sphere(8), factors, shift);
    const Totals totals = check(mesh, queries_about(mesh, random, 60));
    EXPECT_GT(totals.ties, 50U);
    if (factors.z != 0) {
      EXPECT_GT(totals.crossed, 10U);
    }
  }
}

// Differences of coordinates overflow: nothing is certain then, not even that a NaN has a sign.
TEST(ProjectedGrid, FindsWhatAllTrianglesSayOfTheLargestBox) {
  constexpr double l = std::numeric_limits<double>::max();
  std::vector<Vec3> queries;
  for (const double y : {-l, -1.0, 0.0, 1.0, l / 3, l / 2, l}) {
    for (const double z : {-l, -1.0, 0.0, 1.0, l / 3, l / 2, l}) queries.push_back({0.0, y, z});
  }
  EXPECT_GT(check(test::box_mesh({-l, -l, -l}, {l, l, l}), queries).crossed, 30U);
}

TEST(ProjectedGrid, LeavesFewDecisionsToPredicates) {
  test::Random random(4);
  const TriangleMesh mesh = test::sphere(60);
  std::vector<Vec3> queries(2000);
  for (Vec3& q : queries) q = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
  const Totals totals = check(mesh, queries);
  EXPECT_GT(totals.crossed, 800U);
  EXPECT_LT(totals.decided, queries.size() / 50);
}

// Next to a cell whose triangles reach far are others whose triangles do not: rays that start just before one of them.
TEST(ProjectedGrid, MissesNoRayAmongScatteredTriangles) {
  test::Random random(6);
  TriangleMesh mesh;
  std::vector<Vec3> queries;
  const Box box{{0, 0, 0}, {1, 1, 1}}, small{{-0.004, -0.004, -0.004}, {0.004, 0.004, 0.004}};
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const Vec3 at = test::uniform_point(random, box);
    Vec3 sum{0, 0, 0};
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back(at + test::uniform_point(random, small));
      sum = sum + mesh.vertices.back();
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    queries.push_back((1.0 / 3.0) * sum - Vec3{1e-6, 0, 0});
  }
  EXPECT_GT(check(mesh, queries).crossed, queries.size() / 2);
}

// Beside and behind a ball, and a small one beside it.
TEST(ProjectedGrid, KnowsMostRaysThatMeetNothing) {
  test::Random random(5);
  const TriangleMesh small = test::moved(test::sphere(20), {0.05, 0.02, 0.02}, {0.9, 0.9, 0.9});
  const TriangleMesh mesh = test::joined(test::sphere(60), small);
  std::vector<Vec3> queries(4000);
  for (Vec3& q : queries) q = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
  std::size_t ahead = 0;
  for (const Vec3& q : queries) {
    const double across = q.y * q.y + q.z * q.z;
    ahead += across < 1.0 && q.x < std::sqrt(1.0 - across) ? 1 : 0;
  }
  const Totals totals = check(mesh, queries);
  EXPECT_GT(totals.met, ahead);
  EXPECT_LT(totals.met, ahead + queries.size() / 20);
}

// At most so many kB of memory were resident at a time.
long peak_kilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// Needles along y or z, as long as the box: cells of their proportions would be a row of millions.
TEST(ProjectedGrid, TakesNoMoreMemoryForNeedles) {
  for (const bool along_z : {false, true}) {
    test::Random random(3);
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
      const double x = test::uniform(random, -1, 1), at = test::uniform(random, -1, 1);
      for (const auto& [across, along] : {std::pair{at, -1.0}, {at + 1e-10, -1.0}, {at, 1.0}}) {
        mesh.vertices.push_back(along_z ? Vec3{x, across, along} : Vec3{x, along, across});
      }
      mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const long before = peak_kilobytes();
    const ProjectedGrid grid(mesh);
    // Filters and lists take 5 MB, sanitizers three times that; the cells took 140.
    EXPECT_LT(peak_kilobytes() - before, 50'000);
  }
}

}  // namespace
}  // namespace raycone
