#include "core/certificate/border_components.h"

#include <gtest/gtest.h>

#include "core/cells/surface_mesh.h"
#include "core/data/rule.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Rounding may turn flat components over: beside a box, or within it.
TEST(BorderComponents, AreWithoutThoseThatAreTurnedOver) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto small = [](double x, bool turned) {
    const TriangleMesh other = test::box_mesh({x, 0.2, 0.2}, {x + 0.1, 0.3, 0.3});
    return turned ? test::reversed(other) : other;
  };
  const auto left = [&](double x, bool turned) {
    SurfaceMesh surface{test::joined(box, small(x, turned)), {}};
    surface.sources.resize(surface.mesh.triangles.size(), 0);
    EXPECT_TRUE(keep_border(surface, Rule{}));
    return surface.sources.size();
  };
  EXPECT_EQ(left(2.0, false), 24U);
  EXPECT_EQ(left(2.0, true), 12U);
  EXPECT_EQ(left(0.2, true), 24U);  // a cavity
  EXPECT_EQ(left(0.2, false), 12U);
}

}  // namespace
}  // namespace raycone
