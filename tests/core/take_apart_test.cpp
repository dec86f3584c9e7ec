#include "core/arrangement/take_apart.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/certificate.h"
#include "core/data/coordinate_precision.h"
#include "core/data/lattice.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/components.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

constexpr double kDistance = 1e-6;

struct Taken {
  TriangleMesh mesh;
  std::vector<std::uint32_t> sources;
  bool is_apart;
};

Taken taken_apart(const TriangleMesh& mesh, CoordinatePrecision precision = CoordinatePrecision::kDouble) {
  Taken taken{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), false};
  std::iota(taken.sources.begin(), taken.sources.end(), 0);
  taken.is_apart = take_apart(taken.mesh, taken.sources, {kDistance, precision}).has_value();
  return taken;
}

// Of so many components, with nothing moved farther than asked for.
void expect_apart(const TriangleMesh& mesh, std::uint32_t components) {
  const Taken taken = taken_apart(mesh);
  ASSERT_TRUE(taken.is_apart);
  EXPECT_TRUE(is_closed_and_embedded(taken.mesh));
  EXPECT_EQ(components_of(taken.mesh).count, components);
  ASSERT_EQ(taken.sources.size(), taken.mesh.triangles.size());
  for (const Vec3& vertex : taken.mesh.vertices) {
    double nearest = 1.0;
    for (const Vec3& before : mesh.vertices) nearest = std::min(nearest, norm(vertex - before));
    EXPECT_LE(nearest, 1.001 * kDistance);
  }
}

TEST(TakeApart, LeavesAManifoldAsItIs) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const Taken taken = taken_apart(box);
  EXPECT_TRUE(taken.is_apart);
  EXPECT_EQ(taken.mesh.vertices, box.vertices);
  EXPECT_EQ(taken.mesh.triangles, box.triangles);
}

TEST(TakeApart, ParesSolidsThatTouch) {
  expect_apart(test::cells_mesh({{0, 0, 0}, {1, 1, 1}}), 2);                        // in a corner
  expect_apart(test::cells_mesh({{0, 0, 0}, {1, 1, 0}}), 2);                        // along an edge
  expect_apart(test::cells_mesh({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}}), 3);             // along two
  expect_apart(test::cells_mesh({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}), 4);  // along six, in one corner
  expect_apart(test::cells_mesh({{0, 0, 0}, {1, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 1, 1}}), 1);  // but joined elsewhere
}

// The corner of a pyramid, and of a cavity in it, are one: the cavity gets smaller, not the solid.
TEST(TakeApart, TakesCavitiesOffCorners) {
  const auto pyramid = [](double width, double height, bool outward) {
    const TriangleMesh mesh{{{0, 0, 0},
                             {-width, -width, -height},
                             {width, -width, -height},
                             {width, width, -height},
                             {-width, width, -height}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 3, 2}, {1, 4, 3}}};
    return outward ? mesh : test::reversed(mesh);
  };
  const TriangleMesh hollow = test::joined(pyramid(1.0, 1.0, true), pyramid(0.3, 0.5, false));
  EXPECT_FALSE(is_closed_and_embedded(hollow));
  expect_apart(hollow, 2);
  // Two pyramids that stand on each other's tips, one of them hollow.
  const TriangleMesh above = test::moved(pyramid(1.0, 1.0, false), {1, 1, -1}, {0, 0, 0});
  expect_apart(test::joined(hollow, above), 3);
}

// An edge that two walls share from end to end, where these are joined: its middle is taken apart.
TEST(TakeApart, HalvesEdgesWhoseEndsStay) {
  std::vector<std::array<int, 3>> cells;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 3; ++z) {
        const bool is_out = z == 1 && ((x == 1 && y == 1) || (x == 2 && y == 2));  // two cavities that share an edge
        if (!is_out) cells.push_back({x, y, z});
      }
    }
  }
  const TriangleMesh mesh = test::cells_mesh(cells);
  EXPECT_FALSE(is_closed_and_embedded(mesh));
  const Taken taken = taken_apart(mesh);
  ASSERT_TRUE(taken.is_apart);
  EXPECT_TRUE(is_closed_and_embedded(taken.mesh));
  EXPECT_GT(taken.mesh.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(taken.sources.size(), taken.mesh.triangles.size());
}

// What is seen from the origin as a band around most of the z axis, above it or below: there is no way into it for its
// corner at the origin.
TriangleMesh band(double z) {
  constexpr int kSteps = 12;
  TriangleMesh mesh{{{0, 0, 0}}, {}};
  for (int step = 0; step <= kSteps; ++step) {
    const double angle = 5.0 * step / kSteps;  // of 6.28
    for (const double radius : {1.0, 1.5})
      mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back(z > 0.0 ? Triangle{a, b, c} : Triangle{a, c, b});
  };
  constexpr std::uint32_t kLast = 2 * kSteps;
  for (std::uint32_t inner = 1; inner < kLast; inner += 2) {
    add(inner, inner + 1, inner + 3);  // the side away from the origin
    add(inner, inner + 3, inner + 2);
    add(0, inner, inner + 2);
    add(0, inner + 3, inner + 1);
  }
  add(0, 2, 1);
  add(0, kLast + 1, kLast + 2);
  return mesh;
}

// All but one are, with a lid within the solid, or, of cavities, outside of it. The whole volume is that of both but
// for a part of 2^-36.
TEST(TakeApart, CutsCornersOffThatNoWayLeadsInto) {
  EXPECT_TRUE(is_closed_and_embedded(band(1.0)));
  EXPECT_TRUE(is_closed_and_embedded(band(-1.0)));
  const TriangleMesh two = test::joined(band(1.0), band(-1.0));
  const TriangleMesh box = test::box_mesh({-3, -3, -3}, {3, 3, 3});
  const TriangleMesh cavities = test::joined(box, test::reversed(two));
  for (const TriangleMesh& mesh : {two, cavities}) {
    EXPECT_FALSE(is_closed_and_embedded(mesh));
    const Taken taken = taken_apart(mesh);
    ASSERT_TRUE(taken.is_apart);
    EXPECT_TRUE(is_closed_and_embedded(taken.mesh));
    EXPECT_EQ(taken.mesh.triangles.size(), mesh.triangles.size() + 2 * 26 - 2);  // 26 edges, a lid of 24
    EXPECT_EQ(taken.sources.size(), taken.mesh.triangles.size());
    EXPECT_NEAR(test::volume_of(taken.mesh), test::volume_of(mesh), 1e-9);
  }
}

// As many touch in one corner, and in as many ways, as cells can.
TEST(TakeApart, TakesCellsApart) {
  test::Random random(5);
  int touching = 0;
  for (int round = 0; round < 300; ++round) {
    const TriangleMesh mesh = test::random_cells(random, 2 + round % 3);
    if (is_closed_and_embedded(mesh)) continue;
    ++touching;
    for (const CoordinatePrecision precision : {CoordinatePrecision::kDouble, CoordinatePrecision::kSingle}) {
      const Taken taken = taken_apart(mesh, precision);
      EXPECT_TRUE(taken.is_apart) << round;
      EXPECT_TRUE(is_closed_and_embedded(taken.mesh)) << round;
      std::vector<Vec3> rounded = taken.mesh.vertices;
      round_to(CoordinatePrecision::kSingle, rounded);
      EXPECT_EQ(rounded == taken.mesh.vertices, precision == CoordinatePrecision::kSingle) << round;
    }
  }
  EXPECT_GT(touching, 150);
}

// Two cells in a corner, of which the one moves, or the other.
TEST(TakeApart, MovesTheOneThatLeaves) {
  for (const auto& [first, second] : {std::pair<std::array<int, 3>, std::array<int, 3>>{{0, 0, 0}, {1, 1, 1}},
                                      {{1, 0, 0}, {0, 1, 1}},
                                      {{0, 1, 0}, {1, 0, 1}},
                                      {{0, 0, 1}, {1, 1, 0}}}) {
    for (const TriangleMesh& mesh : {test::cells_mesh({first, second}), test::cells_mesh({second, first})}) {
      Taken taken{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), false};
      EXPECT_TRUE(
          take_apart(taken.mesh, taken.sources, {.distance = kDistance, .against_perturbation = true}).has_value());
      EXPECT_TRUE(is_closed_and_embedded(taken.mesh));
    }
  }
}

// Two wedges, one above the other, that share an edge of several parts. Either may leave the other one, both along the
// same axis: where different ones do at the ends of a part, they meet in its middle.
TEST(TakeApart, MovesTheSameOneAllAlongAnEdge) {
  std::vector<std::array<int, 3>> cells;
  for (int y = 0; y < 4; ++y) cells.insert(cells.end(), {{0, y, 1}, {1, y, 0}});
  TriangleMesh wedges = test::cells_mesh(cells);
  for (Vec3& p : wedges.vertices) p = {0.5 * (p.x + p.z), p.y, p.z - p.x};
  test::Random random(9);
  for (int round = 0; round < 20; ++round) {
    const TriangleMesh mesh = test::shuffled(wedges, random);
    Taken taken{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), false};
    ASSERT_TRUE(
        take_apart(taken.mesh, taken.sources, {.distance = kDistance, .against_perturbation = true}).has_value());
    EXPECT_TRUE(is_closed_and_embedded(taken.mesh)) << round;
  }
}

// Nodes on faces, edges and corners of cells stay on the sides that the perturbation has them on.
TEST(TakeApart, KeepsNodesOnTheirSides) {
  Lattice lattice{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {0, 0, 0}, {}};
  const auto nodes = [&](const TriangleMesh& mesh) {
    return nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  };
  test::Random random(6);
  int touching = 0, apart = 0, moved = 0;
  for (int round = 0; round < 200; ++round) {
    const int size = round % 50 == 0 ? 9 : 2 + round % 3;
    lattice.counts.fill(2 * size + 3);
    const TriangleMesh mesh = test::random_cells(random, size);
    if (is_closed_and_embedded(mesh)) continue;
    ++touching;
    Taken taken{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), false};
    taken.is_apart =
        take_apart(taken.mesh, taken.sources, {.distance = kDistance, .against_perturbation = true}).has_value();
    if (!taken.is_apart || !is_closed_and_embedded(taken.mesh)) continue;
    ++apart;
    const NodeSet before = nodes(mesh);
    NodeSet after = nodes(taken.mesh), inside = nodes(taken_apart(mesh).mesh);
    after.flip(before);
    inside.flip(before);
    EXPECT_TRUE(after.empty()) << round;
    moved += inside.empty() ? 0 : 1;  // as nodes are where vertices move into insides
  }
  EXPECT_GT(touching, 100);
  EXPECT_EQ(apart, touching);
  EXPECT_GT(moved, 0.5 * apart);
}

// So do nodes next to outer faces, off them by rounding, as at the end of a box that is divided: parts that touch there
// need not leave the planes of these faces.
TEST(TakeApart, KeepsNodesNextToFacesThatNeedNotMove) {
  constexpr int kSize = 3, kSteps = 47;
  const double h = kSize / double{kSteps};
  ASSERT_LT(kSteps * h, kSize);
  const Lattice lattice{{0, 0, 0}, {h, h, h}, {-1, -1, -1}, {kSteps + 3, kSteps + 3, kSteps + 3}};
  test::Random random(8);
  int touching = 0;
  for (int round = 0; round < 12; ++round) {
    const TriangleMesh mesh = test::random_cells(random, kSize);
    if (is_closed_and_embedded(mesh)) continue;
    ++touching;
    Taken taken{mesh, std::vector<std::uint32_t>(mesh.triangles.size()), false};
    ASSERT_TRUE(
        take_apart(taken.mesh, taken.sources, {.distance = kDistance, .against_perturbation = true}).has_value());
    ASSERT_TRUE(is_closed_and_embedded(taken.mesh));
    NodeSet after = nodes_inside(WindingNumberEvaluator(taken.mesh), Rule{}, lattice);
    after.flip(nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice));
    EXPECT_TRUE(after.empty()) << round;
  }
  EXPECT_GT(touching, 8);
}

// Two plates that share an edge, and are thinner than its ends move: into the insides these end beyond the plates,
// against the perturbation they do not.
TEST(TakeApart, GoesTheNextWayWhereOneWasInVain) {
  const TriangleMesh plates = test::moved(test::cells_mesh({{0, 0, 0}, {1, 1, 0}}), {1, 1, kDistance / 4}, {0, 0, 0});
  const auto taken_after = [&](const std::vector<std::uint8_t>& in_vain) {
    Taken taken{plates, std::vector<std::uint32_t>(plates.triangles.size()), false};
    taken.is_apart =
        take_apart(taken.mesh, taken.sources, {.distance = kDistance, .other_ways = true, .in_vain = in_vain})
            .has_value();
    return taken;
  };
  const std::size_t vertices = plates.vertices.size();
  const Taken first = taken_after({}), second = taken_after(std::vector<std::uint8_t>(vertices, 1));
  EXPECT_TRUE(first.is_apart);
  EXPECT_FALSE(is_closed_and_embedded(first.mesh));
  EXPECT_TRUE(second.is_apart);
  EXPECT_TRUE(is_closed_and_embedded(second.mesh));
  EXPECT_FALSE(taken_after(std::vector<std::uint8_t>(vertices, 4)).is_apart);  // there are no more
}

TEST(TakeApart, TellsWhatVerticesAreCopiesOf) {
  test::Random random(7);
  std::size_t copies = 0;
  for (int round = 0; round < 50; ++round) {
    const TriangleMesh mesh = test::random_cells(random, 3);
    TriangleMesh apart = mesh;
    std::vector<std::uint32_t> sources(mesh.triangles.size());
    const std::optional<std::vector<std::uint32_t>> originals = take_apart(apart, sources, {.distance = kDistance});
    ASSERT_TRUE(originals);
    ASSERT_EQ(originals->size(), apart.vertices.size());
    for (std::size_t v = 0; v < apart.vertices.size(); ++v) {
      const std::uint32_t original = (*originals)[v];
      ASSERT_EQ((*originals)[original], original);
      copies += original != v ? 1 : 0;
      EXPECT_LE(norm(apart.vertices[v] - apart.vertices[original]),
                3 * kDistance);  // either may have moved, by rounding
      EXPECT_TRUE(v >= mesh.vertices.size() || original == v);
    }
  }
}

TEST(TakeApart, RefusesWhatHasNoSides) {
  EXPECT_FALSE(taken_apart(test::open_box()).is_apart);
  EXPECT_FALSE(taken_apart(test::fan(4, 4)).is_apart);
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  taken_apart(test::joined(box, box));  // ends
  taken_apart(test::joined(box, test::reversed(box)));
}

// Two faces are on the first one, which another one goes on behind the edge.
TEST(TakeApart, RefusesFacesThatLieOnEachOther) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {2, 0, 0.25}, {-1, 0, 0.5}, {0, 1, 0.5}};
  const auto close = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {  // with its back
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, b});
  };
  std::array<std::uint32_t, 4> apexes{2, 3, 4, 5};
  do {
    mesh.triangles.clear();
    for (const std::uint32_t apex : apexes) close(0, 1, apex);
    EXPECT_FALSE(taken_apart(mesh).is_apart);
  } while (std::ranges::next_permutation(apexes).found);
}

}  // namespace
}  // namespace raycone
