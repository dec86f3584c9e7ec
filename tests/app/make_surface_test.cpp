#include "app/run/make_surface.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

constexpr std::uint64_t kAllMemory = std::numeric_limits<std::uint64_t>::max();

MadeSurface made(const SurfaceOptions& options) {
  const TriangleMesh mesh = weld(sphere(8), {});
  const Lattice lattice{{-1.25, -1.25, -1.25}, {0.25, 0.25, 0.25}, {0, 0, 0}, {11, 11, 11}};
  return make_surface("m", mesh, WindingNumberEvaluator(mesh), lattice, options, kAllMemory);
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

}  // namespace
}  // namespace raycone::test
