#include "core/filling/embedded_border.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "core/arrangement/take_apart.h"
#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/evaluation/winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

// Two wedges, tip to tip, and a plate so near to these that moves against the perturbation would end in it.
TriangleMesh wedges_beside_a_plate(double gap) {
  TriangleMesh wedges{{{1, 0, 1}, {1, 1, 1}}, {}};
  for (const double z : {2.0, 0.0}) {
    const auto a = static_cast<std::uint32_t>(wedges.vertices.size()), b = a + 1, c = a + 2, d = a + 3;
    wedges.vertices.insert(wedges.vertices.end(), {{0.5, 0, z}, {1.5, 0, z}, {1.5, 1, z}, {0.5, 1, z}});
    TriangleMesh wedge{{}, {{0, b, a}, {1, d, c}, {a, b, c}, {a, c, d}, {0, c, b}, {0, 1, c}, {0, a, d}, {0, d, 1}}};
    if (z < 1.0) wedge = test::reversed(wedge);
    wedges.triangles.insert(wedges.triangles.end(), wedge.triangles.begin(), wedge.triangles.end());
  }
  return test::joined(wedges, test::box_mesh({0.5, 0, 1 - gap / 2}, {1 - gap, 1, 1 + gap / 2}));
}

// Two plates that share an edge, and are thinner than its ends move: into the insides these end beyond the plates,
// against the perturbation they do not.
TriangleMesh plates(double thickness) {
  return test::moved(test::cells_mesh({{0, 0, 0}, {1, 1, 0}}), {1, 1, thickness}, {3, 0, 0});
}

bool is_apart(TriangleMesh mesh, const ApartOptions& options) {
  std::vector<std::uint32_t> sources(mesh.triangles.size());
  std::iota(sources.begin(), sources.end(), 0);
  return take_apart(mesh, sources, options) && is_closed_and_embedded(mesh);
}

TEST(EmbeddedBorder, GoesDifferentWaysAtDifferentPlaces) {
  constexpr double kSpacing = 0.21, kDistance = 0x1p-30 * kSpacing, kSmall = kDistance / 4;
  const TriangleMesh mesh = test::joined(wedges_beside_a_plate(kSmall), plates(kSmall));
  for (const bool against : {false, true}) {
    EXPECT_EQ(is_apart(wedges_beside_a_plate(kSmall), {kDistance, CoordinatePrecision::kDouble, against}), !against);
    EXPECT_EQ(is_apart(plates(kSmall), {kDistance, CoordinatePrecision::kDouble, against}), against);
    EXPECT_FALSE(is_apart(mesh, {kDistance, CoordinatePrecision::kDouble, against}));
  }
  const Lattice lattice{{-0.3, -0.3, -0.3}, {kSpacing, kSpacing, kSpacing}, {0, 0, 0}, {28, 14, 13}};
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  const std::optional<SurfaceMesh> surface = embedded_border(mesh, inside, {});
  ASSERT_TRUE(surface);
  EXPECT_TRUE(faults_of(surface->mesh, inside).none());
  EXPECT_EQ(surface->mesh.triangles.size(), mesh.triangles.size());
}

}  // namespace
}  // namespace raycone
