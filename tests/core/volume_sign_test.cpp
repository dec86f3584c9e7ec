#include "core/exact/volume_sign.h"

#include <gtest/gtest.h>

#include "core/machine/floating_point.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::box_mesh;
using test::joined;

TEST(VolumeSign, IsExact) {
  const DefaultFloatingPoint guard;
  // Volumes cancel but for one in 2^60 of them.
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  const TriangleMesh hole = test::reversed(box_mesh({0, 0, 5}, {1, 1, 6}));
  const TriangleMesh rest = box_mesh({0, 0, 9}, {0x1p-20, 0x1p-20, 9 + 0x1p-20});
  EXPECT_EQ(volume_sign(mesh.triangles, mesh.vertices), 1);
  TriangleMesh sum = joined(mesh, hole);
  EXPECT_EQ(volume_sign(sum.triangles, sum.vertices), 0);
  sum = joined(sum, rest);
  EXPECT_EQ(volume_sign(sum.triangles, sum.vertices), 1);
  sum = test::reversed(sum);
  EXPECT_EQ(volume_sign(sum.triangles, sum.vertices), -1);
}

TEST(VolumeSign, IsZeroWhereRoundedTermsDoNotCancel) {
  const DefaultFloatingPoint guard;
  test::Random random(8);
  const TriangleMesh ball = test::moved(test::sphere(6), {0.1, 0.1, 0.1}, {0.3, 0.7, 0.9});
  const TriangleMesh nothing = joined(test::shuffled(ball, random), test::shuffled(test::reversed(ball), random));
  EXPECT_EQ(volume_sign(nothing.triangles, nothing.vertices), 0);
}

}  // namespace
}  // namespace raycone
