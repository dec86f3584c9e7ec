// Meshes without triangles, blocks without samples, points of which there are none; and more than can be counted.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/distance/distance.h"
#include "core/evaluation/winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kUnset = 7.0;

const std::array<RayEngine, 2> kEngines{RayEngine::kScan, RayEngine::kEmbree};
const Lattice kLattice{{0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}, {0, 0, 0}, {4, 3, 2}};

std::vector<TriangleMesh> empty_meshes() { return {TriangleMesh{}, TriangleMesh{{{0, 0, 0}, {1, kUnbounded, 0}}, {}}}; }

struct DiagnosticsStorage {
  explicit DiagnosticsStorage(std::size_t count)
      : crossings(count, 7), degenerate(count, 7), on_surface(count, 7), error_bound(count, kUnset) {}
  [[nodiscard]] Diagnostics all() { return {crossings, degenerate, on_surface, error_bound}; }
  [[nodiscard]] bool is_zero() const {
    const std::vector<std::int64_t> none(crossings.size(), 0);
    return crossings == none && degenerate == none && on_surface == std::vector<std::uint8_t>(none.size(), 0) &&
           error_bound == std::vector<double>(none.size(), 0.0);
  }
  std::vector<std::int64_t> crossings, degenerate;
  std::vector<std::uint8_t> on_surface;
  std::vector<double> error_bound;
};

TEST(EmptyMesh, HasTheWindingNumberZeroEverywhere) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 2, 3}, {-1e300, 5e-324, 0}};
  for (const TriangleMesh& mesh : empty_meshes()) {
    for (const RayEngine engine : kEngines) {
      const WindingNumberEvaluator evaluator(mesh, {.ray_engine = engine});
      evaluator.prepare_points();
      EXPECT_EQ(evaluator.exterior_edges(), 0U);
      std::vector<double> values(24, kUnset), at_points(points.size(), kUnset);
      DiagnosticsStorage of_lattice(24), of_points(points.size());
      const Diagnostics lattice_diagnostics = of_lattice.all(), point_diagnostics = of_points.all();
      std::atomic<std::uint64_t> done = 0;
      const Tally tally = evaluator.evaluate(kLattice, whole(kLattice), values, &done, &lattice_diagnostics);
      (void)evaluator.evaluate(points, at_points, &done, &point_diagnostics);
      EXPECT_EQ(values, std::vector<double>(24, 0.0));
      EXPECT_EQ(at_points, std::vector<double>(points.size(), 0.0));
      EXPECT_TRUE(of_lattice.is_zero());
      EXPECT_TRUE(of_points.is_zero());
      EXPECT_EQ(tally.degenerate + tally.on_surface, 0U);
      EXPECT_EQ(done, 24 + points.size());
    }
  }
}

TEST(EmptyMesh, IsInfinitelyFarAway) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 2, 3}};
  for (const TriangleMesh& mesh : empty_meshes()) {
    const DistanceEvaluator evaluator(mesh);
    evaluator.prepare_points();
    std::vector<double> distances(24, kUnset), at_points(points.size(), kUnset);
    evaluator.evaluate(kLattice, whole(kLattice), 1.5, distances);
    evaluator.evaluate(points, at_points);
    EXPECT_EQ(distances, std::vector<double>(24, 1.5));
    EXPECT_EQ(at_points, std::vector<double>(points.size(), kUnbounded));
  }
}

TEST(EmptyBlock, IsEvaluatedWithoutAnEffect) {
  for (const TriangleMesh& mesh : {test::box_mesh({0, 0, 0}, {1, 1, 1}), test::open_box(), TriangleMesh{}}) {
    for (const RayEngine engine : kEngines) {
      const WindingNumberEvaluator evaluator(mesh, {.ray_engine = engine});
      const DistanceEvaluator distance(mesh);
      for (const std::array<std::int64_t, 3>& counts :
           {std::array<std::int64_t, 3>{0, 0, 0}, {0, 3, 2}, {4, 0, 2}, {4, 3, 0}, {4, 0, 0}}) {
        const LatticeBlock block{{0, 0, 0}, counts};
        std::atomic<std::uint64_t> done = 0;
        const Diagnostics none{};
        const Tally tally = evaluator.evaluate(kLattice, block, {}, &done, &none);
        EXPECT_EQ(tally.degenerate + tally.on_surface + done, 0U);
        distance.evaluate(kLattice, block, 1.0, {});
      }
      const Tally tally = evaluator.evaluate(std::span<const Vec3>{}, {});
      EXPECT_EQ(tally.degenerate + tally.on_surface, 0U);
      distance.evaluate(std::span<const Vec3>{}, {});
    }
  }
}

TEST(Counts, OfMoreThan32BitsAreRefused) {
  const WindingNumberEvaluator evaluator(test::open_box());
  const DistanceEvaluator distance(test::open_box());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    LatticeBlock block{{0, 0, 0}, {0, 0, 0}};  // of which there are no samples: nothing is allocated
    block.counts[axis] = kMaxBlockSide;
    EXPECT_NO_THROW((void)evaluator.evaluate(kLattice, block, {}));
    EXPECT_NO_THROW(distance.evaluate(kLattice, block, 1.0, {}));
    ++block.counts[axis];
    EXPECT_THROW((void)evaluator.evaluate(kLattice, block, {}), std::length_error);
    EXPECT_THROW(distance.evaluate(kLattice, block, 1.0, {}), std::length_error);
  }
}

}  // namespace
}  // namespace raycone
