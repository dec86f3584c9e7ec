#include "app/fields/make_surface.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "app/options/field_options.h"
#include "app/process/memory_limit.h"
#include "core/cells/node_set.h"
#include "io/files/file_error.h"
#include "tests/support/error_text.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

constexpr std::uint64_t kAllMemory = std::numeric_limits<std::uint64_t>::max();

MadeSurface made_of(const TriangleMesh& mesh, const Lattice& lattice, const SurfaceOptions& options = {},
                    std::uint64_t memory = kAllMemory) {
  return make_surface({mesh, exterior_edges(mesh), "m"}, lattice, options, memory);
}

// Around the unit sphere.
const Lattice kCoarse{{-1.25, -1.25, -1.25}, {0.25, 0.25, 0.25}, {0, 0, 0}, {11, 11, 11}};

MadeSurface made(const SurfaceOptions& options) { return made_of(sphere(8), kCoarse, options); }

// A band of a sphere, which needs a contour: what is inside is a ring.
TriangleMesh ring() {
  TriangleMesh mesh = sphere(8);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return std::abs(mesh.vertices[v].z) > 0.5; });
  });
  return mesh;
}

// With the number, once the nodes are known, and before any other work. Half of what is predicted is too little; what
// is predicted does. A mesh that is its own surface needs less.
TEST(MakeSurface, IsRefusedWhereItsMemoryDoesNotDo) {
  const TriangleMesh mesh = ring();
  const Lattice lattice{{-1.25, -1.25, -1.25}, {0.025, 0.025, 0.025}, {0, 0, 0}, {101, 101, 101}};
  const WindingNumberEvaluator evaluator(mesh);
  const double predicted = surface_bytes(nodes_inside(evaluator, Rule{}, lattice), mesh.triangles.size());
  EXPECT_GT(predicted, 2.0 * node_set_bytes(lattice));  // else the nodes would be refused
  int stages = 0;
  SurfaceOptions options;
  options.at_stage = [&](const char*) { ++stages; };
  const auto make = [&](double share, const TriangleMesh& of) {
    malloc_trim(0);  // as check_memory() does: what other tests have freed is no longer in use then
    return made_of(of, lattice, options, static_cast<std::uint64_t>(memory_in_use() + share * predicted));
  };
  const std::string refused = error_text<LimitError>([&] { return make(0.5, mesh); });
  EXPECT_TRUE(refused.starts_with("m: needs about ")) << refused;
  EXPECT_EQ(stages, 1);  // a look at the mesh itself
  EXPECT_GT(make(1.1, mesh).report.faces, 0U);
  EXPECT_EQ(make(0.5, sphere(8)).report.faces, 224U);
}

TEST(MakeSurface, TellsThatNothingIsSimplified) {
  SurfaceOptions options;
  const MadeSurface merged = made(options);
  EXPECT_TRUE(merged.warnings.empty());
  options.simplify = 0.1;
  const MadeSurface simplified = made(options);
  EXPECT_TRUE(simplified.warnings.empty());
  EXPECT_LT(simplified.report.faces, merged.report.faces);
  options.rounds = 0;
  const MadeSurface left = made(options);
  ASSERT_EQ(left.warnings.size(), 1U);
  EXPECT_EQ(left.warnings[0].name, "not-simplified");
  EXPECT_EQ(left.surface.mesh.triangles, merged.surface.mesh.triangles);
}

TEST(MakeSurface, TellsThatADistanceIsTooSmallToSimplify) {
  SurfaceOptions options;
  options.simplify = 1e-9;  // 16 margins of 2^-30 voxels of 0.25 are 3.7e-9
  const MadeSurface left = made_of(ring(), kCoarse, options);
  ASSERT_EQ(left.warnings.size(), 1U);
  EXPECT_EQ(left.warnings[0].name, "not-simplified");
  EXPECT_NE(left.warnings[0].text.find("rounding"), std::string::npos);
  options.simplify = 1e-8;
  EXPECT_TRUE(made_of(ring(), kCoarse, options).warnings.empty());
}

// A post, of which another box, turned inside out, takes all but a foot and a slice on top, between the nodes.
TEST(MakeSurface, TellsThatPiecesAreLost) {
  const auto warnings = [](double top) {
    const TriangleMesh mesh = joined(box_mesh({0, 0, 0}, {1, 1, 3}), reversed(box_mesh({-1, -1, 1}, {2, 2, top})));
    const Lattice lattice{{-1.4, -1.4, -0.4}, {0.25, 0.25, 0.25}, {0, 0, 0}, {15, 15, 16}};
    return made_of(mesh, lattice).warnings;
  };
  ASSERT_EQ(warnings(2.97).size(), 1U);
  EXPECT_EQ(warnings(2.97)[0].name, "thin-parts");
  EXPECT_NE(warnings(2.97)[0].text.find("1 part as a whole"), std::string::npos) << warnings(2.97)[0].text;
  EXPECT_TRUE(warnings(2.4).empty());
}

// Parts that touch are taken apart by some roundings, which is more than E so far from the origin: into their insides,
// as no sample is on their faces. A vertex that has moved so is not in a hole.
TEST(MakeSurface, ReportsNoHolesOfAClosedMesh) {
  constexpr double kFar = 1e12, kVoxel = 0.1875;
  const auto box = [](const Vec3& lower, const Vec3& upper) {
    const Vec3 far{kFar, kFar, kFar};
    return box_mesh(far + lower, far + upper);
  };
  const TriangleMesh mesh = joined(box({2, 0, 1}, {3, 3, 2}), box({2, 0, 1}, {3, 1, 3}));
  const Lattice lattice{
      {kFar + 1.84375, kFar - 0.21875, kFar + 0.71875}, {kVoxel, kVoxel, kVoxel}, {0, 0, 0}, {9, 20, 15}};
  SurfaceOptions options{.rule = *rule_from_name("odd"), .simplify = 3e-4};
  const MadeSurface made = made_of(mesh, lattice, options);
  EXPECT_EQ(made.report.hole_area, 0.0);
  EXPECT_GT(made.report.max_distance, options.simplify) << "or nothing was taken apart";
}

TEST(MakeSurface, TellsWhatItsNodesTook) {
  TriangleMesh open = box_mesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  const Lattice lattice{{-0.5, -0.5, -0.5}, {0.25, 0.25, 0.25}, {0, 0, 0}, {9, 9, 9}};
  const MadeSurface made = made_of(open, lattice);
  const WindingNumberEvaluator evaluator(open);
  std::vector<std::uint8_t> sides(static_cast<std::size_t>(whole(lattice).size()));
  const Tally tally = evaluator.evaluate_sides({}, lattice, whole(lattice), sides);
  EXPECT_GT(tally.degenerate, 0U);
  EXPECT_GT(tally.on_surface, 0U);
  EXPECT_EQ(made.tally.degenerate, tally.degenerate);
  EXPECT_EQ(made.tally.on_surface, tally.on_surface);
  EXPECT_GE(made.terms.near, evaluator.terms().near);
  EXPECT_GT(evaluator.terms().near, 0U);
}

// A fin on a box, 1.2 voxels high: all of it is nearer to the contour than a cell's diagonal.
TEST(MakeSurface, TellsThatWallsAreLostNextToTheSurface) {
  const Lattice lattice{{-0.4, -0.4, -0.4}, {0.25, 0.25, 0.25}, {0, 0, 0}, {8, 8, 9}};
  const auto warnings = [&](double top) {
    const TriangleMesh mesh = joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({0.3, 0.4, 0.9}, {0.7, 0.41, top}));
    SurfaceOptions options;
    options.merge_planes = false;  // else the mesh's own faces are kept
    return made_of(mesh, lattice, options).warnings;
  };
  ASSERT_EQ(warnings(1.3).size(), 1U);
  EXPECT_EQ(warnings(1.3)[0].name, "thin-parts");
  EXPECT_TRUE(warnings(0.95).empty());  // within the box
}

// A box with a post on a corner, thinner than a cell.
TEST(MakeSurface, DoesNotTellOfNextToNoArea) {
  const Lattice lattice{{-0.4, -0.4, -0.4}, {0.25, 0.25, 0.25}, {0, 0, 0}, {8, 8, 9}};
  const auto warnings = [&](double width) {
    const TriangleMesh post = box_mesh({1, 1, 1}, {1 + width, 1 + width, 1.3});
    const TriangleMesh mesh = joined(box_mesh({0, 0, 0}, {1, 1, 1}), post);
    SurfaceOptions options;
    options.merge_planes = false;  // else the mesh's own faces are kept
    return made_of(mesh, lattice, options).warnings;
  };
  ASSERT_EQ(warnings(1e-3).size(), 1U);
  EXPECT_EQ(warnings(1e-3)[0].text.find("as a whole"), std::string::npos);
  EXPECT_TRUE(warnings(1e-11).empty());
}

// A sphere and, beside it, a plate between the nodes, closed or a sheet.
TEST(MakeSurface, TellsThatPartsAreTooThin) {
  const Lattice lattice{{-1.25, -1.25, -1.25}, {0.25, 0.25, 0.25}, {0, 0, 0}, {11, 11, 30}};
  const auto names = [&](double height, double thickness) {
    TriangleMesh mesh = sphere(8);
    const TriangleMesh plate = box_mesh({-0.9, -0.9, 4.05}, {0.9, 0.9, 4.05 + height});
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), plate.vertices.begin(), plate.vertices.end());
    for (const Triangle& t : plate.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    SurfaceOptions options;
    options.thickness = thickness;
    const MadeSurface made = made_of(mesh, lattice, options);
    return made.warnings.empty() ? std::string() : line_of(made.warnings.at(0));
  };
  EXPECT_EQ(names(0.5, 0.0), "");
  const std::string thin = names(0.1, 0.0);
  EXPECT_TRUE(thin.starts_with("thin-parts: ")) << thin;
  EXPECT_NE(thin.find(", 1 part as a whole"), std::string::npos) << thin;
  EXPECT_TRUE(names(0.01, 0.01).starts_with("thin-parts: "));  // grown, and too thin still
  EXPECT_EQ(names(0.01, 0.22), "");                            // half of the diagonal of a voxel is 0.217
}

}  // namespace
}  // namespace raycone::test
