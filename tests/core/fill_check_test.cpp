#include "core/filling/fill_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/cells/surface_mesh.h"
#include "core/evaluation/winding_number.h"
#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Of a box, which has another's lid: only one of both is on it.
TEST(FillCheck, TellsWhetherFacesAreLost) {
  const DefaultFloatingPoint guard;
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const WindingNumberEvaluator evaluator(box);
  const RuleAlong along(evaluator, Rule{});
  const auto keeps = [&](double top) {
    SurfaceMesh surface{test::box_mesh({0, 0, 0}, {1, 1, top}), {}};
    for (std::int32_t face = 0; face < 12; ++face) {
      const auto [a, b, c] = surface.mesh.triangles[static_cast<std::size_t>(face)];
      const bool is_lid =
          std::min({surface.mesh.vertices[a].z, surface.mesh.vertices[b].z, surface.mesh.vertices[c].z}) > 0;
      surface.sources.push_back(is_lid ? kHole : face);
    }
    return keeps_what_separates(surface, lost_area(surface, box, along, 0.1), 0.1);
  };
  EXPECT_TRUE(keeps(1.0));
  EXPECT_TRUE(keeps(0.98));
  EXPECT_FALSE(keeps(0.9));
}

}  // namespace
}  // namespace raycone
