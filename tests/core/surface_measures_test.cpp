// What is said about a surface: how far it is from the mesh, and what of the mesh is not on it.
#include "core/surface/surface_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/distance/distance.h"
#include "core/surface/surface.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::largest_distance_of;
using test::Random;
using test::rotated;
using test::surface_of;
using test::uniform;

DroppedSamples dropped_samples(const SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside,
                               double thickness = 0.0, SurfaceFaces faces = SurfaceFaces::kOfContour) {
  const double farthest = farthest_kept(mesh, inside.lattice(), faces, CoordinatePrecision::kDouble) + thickness;
  return {surface, inside, thickness, farthest, {}};
}

DroppedArea dropped_of(const SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside,
                       SurfaceFaces faces = SurfaceFaces::kOfContour) {
  DroppedSamples dropped = dropped_samples(surface, mesh, inside, 0.0, faces);
  return dropped_area(mesh, dropped);
}

TEST(SurfaceMeasures, TellWhatSeparatesNothing) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh wall = box;
  wall.vertices.insert(wall.vertices.end(), {{0.5, 0.2, 0.2}, {0.5, 0.8, 0.2}, {0.5, 0.2, 0.8}});
  const auto first = static_cast<std::uint32_t>(box.vertices.size());
  wall.triangles.push_back({first, first + 1, first + 2});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  EXPECT_NEAR(dropped_of(surface, wall, inside).area, 0.18, 1e-12);
  EXPECT_EQ(dropped_of(surface, box, inside).area, 0.0);
  EXPECT_TRUE(dropped_of(surface, wall, inside).is_some);
  EXPECT_FALSE(dropped_of(surface, box, inside).is_some);
}

// A sheet in a box, so far from faces that are the mesh's own.
TEST(SurfaceMeasures, TellFacesNextToTheSurfaceFromItsOwn) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const auto dropped_at = [&, &surface = surface](double voxels) {
    const double x = voxels * lattice.spacing.x;
    TriangleMesh mesh = box;
    test::add_triangle(mesh, {x, 0.2, 0.2}, {x, 0.8, 0.2}, {x, 0.2, 0.8});
    return dropped_of(surface, mesh, inside, SurfaceFaces::kOfMesh).area;
  };
  EXPECT_EQ(dropped_at(0.001), 0.0);
  EXPECT_NEAR(dropped_at(0.01), 0.18, 1e-12);
}

// Far from the origin, in double precision.
TEST(SurfaceMeasures, AreAsFineFarAway) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1}), far = test::moved(box, {1, 1, 1}, {1e6 + 0.1, 0, 0});
  const auto lattice_of = [](const TriangleMesh& mesh) {
    return Lattice{bounding_box(mesh).lower, {0.1, 0.1, 0.1}, {-1, -1, -1}, {12, 12, 12}};
  };
  const auto off = [&](const TriangleMesh& mesh, CoordinatePrecision precision) {
    return farthest_kept(mesh, lattice_of(mesh), SurfaceFaces::kOfMesh, precision);
  };
  EXPECT_NEAR(off(box, CoordinatePrecision::kDouble), 2e-4, 1e-4);  // 2^-9 voxels
  EXPECT_NEAR(off(far, CoordinatePrecision::kDouble), 2e-4, 1e-4);
  EXPECT_NEAR(off(far, CoordinatePrecision::kSingle), 0.25 * 0.1 * std::sqrt(3.0),
              1e-9);  // more is too much in any case
}

// Many are looked at together. Each is as its own distance says.
TEST(SurfaceMeasures, DropWhatIsFarPointByPoint) {
  Random random(41);
  const auto [surface, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 20);
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto point = [&](double most) {
    return Vec3{uniform(random, -most, most), uniform(random, -most, most), uniform(random, -most, most)};
  };
  for (std::uint32_t n = 0; n < 300; ++n) {  // large ones, small ones, and needles, in and out of the box
    const Vec3 a = Vec3{0.5, 0.5, 0.5} + point(0.7), to_b = point(n % 3 == 0 ? 0.9 : 0.05), to_c = point(0.05);
    test::add_triangle(mesh, a, a + to_b, n % 7 == 0 ? mesh.vertices[0] : a + to_c);
  }
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  for (const SurfaceFaces faces : {SurfaceFaces::kOfContour, SurfaceFaces::kOfMesh}) {
    DroppedSamples dropped = dropped_samples(surface, mesh, inside, 0.25 * lattice.spacing.x, faces);
    const double farthest =
        farthest_kept(mesh, lattice, faces, CoordinatePrecision::kDouble) + 0.25 * lattice.spacing.x;
    std::size_t count = 0, far = 0;
    dropped.for_each(mesh, [&](const AreaSamples& samples, const std::vector<bool>& is_dropped) {
      std::vector<double> distances(samples.points.size());
      DistanceEvaluator(surface.mesh).evaluate(samples.points, distances);
      for (std::size_t n = 0; n < is_dropped.size(); ++n) ASSERT_EQ(is_dropped[n], distances[n] > farthest) << n;
      count += is_dropped.size();
      far += static_cast<std::size_t>(std::ranges::count(is_dropped, true));
    });
    EXPECT_GT(count, 10000U);
    EXPECT_GT(far, count / 4);
    EXPECT_LT(far, 3 * count / 4);
  }
}

// A triangle as one, and as a fan of needles, has the same area.
TEST(SurfaceMeasures, AddUpNeedles) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh needles = box;
  const auto first = static_cast<std::uint32_t>(box.vertices.size());
  needles.vertices.push_back({0.5, 0.2, 0.2});
  constexpr std::uint32_t kNeedles = 200;
  for (std::uint32_t n = 0; n <= kNeedles; ++n) {
    needles.vertices.push_back({0.5, 0.8 - 0.6 * n / kNeedles, 0.2 + 0.6 * n / kNeedles});
    if (n > 0) needles.triangles.push_back({first, first + n, first + n + 1});
  }
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  EXPECT_NEAR(dropped_of(surface, needles, inside).area, 0.18, 1e-12);  // a sum of some thousand parts
}

// They find most distances without a search.
TEST(SurfaceMeasures, AreTheLargestDistanceFromTheMesh) {
  Random random(26);
  for (int round = 0; round < 6; ++round) {
    const TriangleMesh mesh = rotated(round % 2 == 0 ? test::open_box() : test::sphere(9));
    SurfaceOptions options;
    options.precision = round > 3 ? CoordinatePrecision::kSingle : CoordinatePrecision::kDouble;
    auto [surface, lattice] = surface_of(mesh, 16 + round, options);
    // Some vertices off the mesh, as nothing makes them: not what their sources say.
    if (round % 3 == 2) surface.mesh.vertices[surface.mesh.triangles[7][0]].x += 3.0 * lattice.spacing.x;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < surface.sources.size(); ++i) {
      if (surface.sources[i] == kHole) continue;
      for (const std::uint32_t corner : surface.mesh.triangles[i]) points.push_back(surface.mesh.vertices[corner]);
    }
    EXPECT_EQ(measure_surface(surface, mesh, lattice).max_distance, largest_distance_of(points, mesh)) << round;
  }
}

// Where products of lengths overflow, and where another part is so far away that distances round to voxels.
TEST(SurfaceMeasures, DoNotDependOnUnitsAndFarParts) {
  TriangleMesh box = rotated(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  for (Triangle& t : box.triangles) {  // first the corner with the right angle
    const auto is_right = [&] {
      const Vec3& at = box.vertices[t[0]];
      return std::abs(dot(box.vertices[t[1]] - at, box.vertices[t[2]] - at)) < 0.5;
    };
    while (!is_right()) std::ranges::rotate(t, t.begin() + 1);
  }
  auto [surface, lattice] = surface_of(box, 12);
  surface.mesh.vertices[surface.mesh.triangles[7][0]].x += 0.125;
  const double expected = measure_surface(surface, box, lattice).max_distance;
  EXPECT_GT(expected, 0.01);
  for (const int exponent : {-300, 270, 332, 600}) {
    const double unit = std::ldexp(1.0, exponent);
    SurfaceMesh scaled = surface;
    scaled.mesh = test::moved(scaled.mesh, {unit, unit, unit}, {});
    Lattice here = lattice;
    here.origin = unit * here.origin;
    here.spacing = unit * here.spacing;
    EXPECT_EQ(measure_surface(scaled, test::moved(box, {unit, unit, unit}, {}), here).max_distance, unit * expected);
  }
  for (const double far : {1e30, 1e90, 1e150}) {  // at the last one, the evaluator alone tells more than 0.17
    const TriangleMesh two = test::joined(box, test::box_mesh({far, far, far}, {2 * far, 2 * far, 2 * far}));
    // As far as sources tell: the nearest triangle may be another one.
    const double found = measure_surface(surface, two, lattice).max_distance;
    EXPECT_GE(found, expected * (1 - 1e-9)) << far;
    EXPECT_LE(found, 0.125) << far;
  }
}

// A box beside a plate of a tenth of a voxel, which lies between nodes.
TEST(SurfaceMeasures, TellWhatIsTooThin) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const auto thin = [&, &surface = surface](const TriangleMesh& other, double thickness) {
    TriangleMesh mesh = box;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const WindingNumberEvaluator evaluator(mesh);
    DroppedSamples dropped = dropped_samples(surface, mesh, inside, thickness);
    return thin_parts(mesh, RuleAlong(evaluator, Rule{}), dropped);
  };
  const double h = lattice.spacing.x;
  // A gap within the box, and the same faces the other way round, which separate nothing there.
  const TriangleMesh plate = test::box_mesh({0.3, 0.3, 0.5}, {0.7, 0.7, 0.5 + 0.1 * h});
  TriangleMesh gap = plate;
  for (Triangle& t : gap.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(thin(plate, 0.0).area, 0.0);
  EXPECT_EQ(thin(plate, 0.0).lost, 0U);
  EXPECT_NEAR(thin(gap, 0.0).area, 2 * 0.16 + 4 * 0.4 * 0.1 * h, 1e-12);
  EXPECT_EQ(thin(gap, 0.0).lost, 1U);
  EXPECT_EQ(thin(gap, h / 4).area, 0.0);  // within the set
  // Beyond the lattice, nothing counts.
  EXPECT_EQ(thin(test::moved(gap, {1, 1, 1}, {5, 0, 0}), 0.0).area, 0.0);
  EXPECT_EQ(thin(test::moved(plate, {1, 1, 1}, {5, 0, 0}), h / 4).area, 0.0);
}

// Nearer to what is left than a cell's diagonal, and still lost.
TEST(SurfaceMeasures, TellComponentsThatNoFaceIsOf) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const double h = lattice.spacing.x;
  const TriangleMesh cavity =
      test::joined(box, test::reversed(test::box_mesh({0.3, 0.3, 0.2 * h}, {0.7, 0.7, 0.6 * h})));
  const double area = 2 * 0.16 + 4 * 0.4 * 0.4 * h;
  EXPECT_NEAR(dropped_of(surface, cavity, inside).area, area, 1e-12);
  DroppedSamples dropped = dropped_samples(surface, cavity, inside);
  const WindingNumberEvaluator evaluator(cavity);
  const ThinParts thin = thin_parts(cavity, RuleAlong(evaluator, Rule{}), dropped);
  EXPECT_NEAR(thin.area, area, 1e-12);
  EXPECT_EQ(thin.lost, 1U);
  // What is there twice is not lost, but for what is off.
  const TriangleMesh twice = test::joined(box, test::moved(box, {1, 1, 1}, {1e-4 * h, 0, 0}));
  EXPECT_EQ(dropped_of(surface, twice, inside).area, 0.0);
}

// Where they are many, one is asked about for several.
TEST(SurfaceMeasures, AddUpManyThinParts) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 128);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const double h = lattice.spacing.x;
  TriangleMesh mesh = box;
  constexpr int kGaps = 40;
  for (int n = 0; n < kGaps; ++n) {
    const double z = (n + 30) * h;
    mesh = test::joined(mesh, test::reversed(test::box_mesh({0.2, 0.2, z + 0.2 * h}, {0.8, 0.8, z + 0.3 * h})));
  }
  DroppedSamples dropped = dropped_samples(surface, mesh, inside);
  EXPECT_GT(dropped_area(mesh, dropped).samples, std::uint64_t{1} << 18);
  const WindingNumberEvaluator evaluator(mesh);
  const ThinParts thin = thin_parts(mesh, RuleAlong(evaluator, Rule{}), dropped);
  EXPECT_NEAR(thin.area, kGaps * (2 * 0.36 + 4 * 0.6 * 0.1 * h), 1e-9);  // a sum of some 500 000
  EXPECT_EQ(thin.lost, std::uint64_t{kGaps});
}

}  // namespace
}  // namespace raycone
