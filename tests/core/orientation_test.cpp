// --orient: what is inside afterwards, whatever the orientation, the order and the number of copies of faces before.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "core/evaluation/winding_number.h"
#include "core/mesh/mesh_statistics.h"
#include "core/mesh/weld.h"
#include "core/orientation/orient.h"
#include "tests/support/direct_winding_number.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::box_mesh;
using test::joined;
using test::Random;

TriangleMesh sphere_of(double radius, const Vec3& centre = {}, int rings = 6) {
  return test::moved(test::sphere(rings), {radius, radius, radius}, centre);
}

TriangleMesh welded(const TriangleMesh& mesh) { return weld(mesh, {}); }

void reverse(Triangle& t) { std::swap(t[1], t[2]); }

TriangleMesh with_faces_reversed(TriangleMesh mesh, Random& random, double share) {
  for (Triangle& t : mesh.triangles) {
    if (test::uniform(random, 0.0, 1.0) < share) reverse(t);
  }
  return mesh;
}

// Each face twice, once reversed, in another order.
TriangleMesh doubled(TriangleMesh mesh, Random& random) {
  std::vector<Triangle> back = mesh.triangles;
  for (Triangle& t : back) reverse(t);
  mesh.triangles.insert(mesh.triangles.end(), back.begin(), back.end());
  return test::shuffled(mesh, random);
}

TriangleMesh automatic(const TriangleMesh& mesh) { return orient(mesh, Orient::kAuto).mesh; }

// The oriented faces by coordinates, sorted, each in the least of its rotations.
std::vector<std::array<Vec3, 3>> set_of_faces(const TriangleMesh& mesh) {
  const auto before = [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                        [](const Vec3& p, const Vec3& q) { return lexicographic_order(p, q) < 0; });
  };
  std::vector<std::array<Vec3, 3>> faces;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const std::array<std::array<Vec3, 3>, 3> rotations{{{a, b, c}, {b, c, a}, {c, a, b}}};
    faces.push_back(*std::min_element(rotations.begin(), rotations.end(), before));
  }
  std::sort(faces.begin(), faces.end(), before);
  return faces;
}

double winding(const TriangleMesh& mesh, const Vec3& q) { return std::round(test::direct_winding_number(mesh, q)); }

// Every way in which faces may have been stored, without losing which of them there are.
std::vector<TriangleMesh> damaged(const TriangleMesh& mesh) {
  Random random(7);
  return {test::reversed(mesh),
          with_faces_reversed(mesh, random, 0.05),
          with_faces_reversed(mesh, random, 0.5),
          with_faces_reversed(mesh, random, 0.95),
          doubled(mesh, random),
          joined(mesh, with_faces_reversed(mesh, random, 0.3)),
          test::shuffled(with_faces_reversed(mesh, random, 0.2), random)};
}

void expect_restored(const TriangleMesh& mesh) {
  const auto expected = set_of_faces(mesh);
  EXPECT_TRUE(set_of_faces(automatic(mesh)) == expected);
  std::size_t way = 0;
  for (const TriangleMesh& other : damaged(mesh)) {
    EXPECT_TRUE(set_of_faces(automatic(welded(other))) == expected) << "way " << way;
    ++way;
  }
}

// ---- Keep and flip ----

TEST(Orient, KeepChangesNothing) {
  const TriangleMesh mesh = test::assorted_triangles();
  const OrientedMesh kept = orient(mesh, Orient::kKeep);
  EXPECT_EQ(kept.mesh.triangles, mesh.triangles);
  EXPECT_EQ(kept.counts.flipped_faces + kept.counts.patches + kept.counts.dropped_duplicates, 0U);
}

TEST(Orient, FlipReversesEveryFaceAndTwiceNone) {
  const TriangleMesh mesh = sphere_of(1);
  const OrientedMesh once = orient(mesh, Orient::kFlip);
  EXPECT_EQ(once.counts.flipped_faces, mesh.triangles.size());
  EXPECT_EQ(winding(once.mesh, {0.1, 0.2, 0.3}), -1);
  EXPECT_EQ(orient(once.mesh, Orient::kFlip).mesh.triangles, mesh.triangles);
}

// ---- Closed patches ----

TEST(Orient, LeavesARightClosedMeshAsItIs) {
  const TriangleMesh mesh = joined(sphere_of(1), test::reversed(sphere_of(0.5)));
  const OrientedMesh oriented = orient(mesh, Orient::kAuto);
  EXPECT_EQ(oriented.mesh.triangles, mesh.triangles);
  EXPECT_EQ(oriented.mesh.vertices, mesh.vertices);
  EXPECT_EQ(oriented.counts.flipped_faces, 0U);
  EXPECT_EQ(oriented.counts.patches, 2U);
}

TEST(Orient, TurnsAClosedMeshOutwardHoweverItIsStored) { expect_restored(sphere_of(1)); }

TEST(Orient, KeepsAHollowSphereHollow) { expect_restored(joined(sphere_of(1), test::reversed(sphere_of(0.5)))); }

TEST(Orient, AlternatesByNesting) {
  expect_restored(joined(joined(sphere_of(1), test::reversed(sphere_of(0.7))),
                         joined(sphere_of(0.5), test::reversed(sphere_of(0.2)))));
}

TEST(Orient, KeepsTheRelationOfPatchesThatAgreeAsStored) {
  const TriangleMesh both_outward = joined(sphere_of(1), sphere_of(0.5));
  EXPECT_EQ(set_of_faces(automatic(both_outward)), set_of_faces(both_outward));
  EXPECT_EQ(set_of_faces(automatic(test::reversed(both_outward))), set_of_faces(both_outward));
  // One face of the outer sphere tells that its orientation means nothing; neither does that of doubled faces.
  TriangleMesh broken = both_outward;
  reverse(broken.triangles.front());
  EXPECT_EQ(winding(automatic(broken), {0.1, 0, 0}), 0);
  Random random(1);
  EXPECT_EQ(winding(automatic(welded(doubled(both_outward, random))), {0.1, 0, 0}), 0);
  EXPECT_EQ(winding(automatic(welded(joined(both_outward, test::reversed(both_outward)))), {0.1, 0, 0}), 0);
}

// A grandchild keeps its relation to its parent, which was turned over.
TEST(Orient, CarriesRelationsThroughTheNesting) {
  TriangleMesh outer = sphere_of(1);
  reverse(outer.triangles.front());
  const TriangleMesh oriented = automatic(joined(outer, joined(sphere_of(0.7), sphere_of(0.4))));
  EXPECT_EQ(winding(oriented, {0.8, 0, 0}), 1);
  EXPECT_EQ(winding(oriented, {0.5, 0, 0}), 0);
  EXPECT_EQ(winding(oriented, {0.1, 0, 0}), -1);
}

TEST(Orient, TakesAnArmThroughABodyForNoCavity) {
  // Its box sticks out along x; that of the second one does not, but its end sticks out of the sphere.
  expect_restored(joined(sphere_of(1), box_mesh({0.2, -0.1, -0.1}, {2, 0.1, 0.1})));
  expect_restored(joined(sphere_of(1, {}, 12), box_mesh({-0.1, 0.1, 0.1}, {0.9, 0.9, 0.9})));
}

TEST(Orient, TakesANeighbourInTheSameBoxForNoCavity) {
  TriangleMesh wedge{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  expect_restored(joined(wedge, box_mesh({2.5, 2.5, 2.5}, {3, 3, 3})));
}

TEST(Orient, CountsACavityThatTouchesItsWallAsACavity) {
  // The octahedron's corners lie on the sides of the box; another corner lies inside.
  TriangleMesh octahedron{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -0.5}}, {}};
  for (const std::uint32_t x : {0U, 1U}) {
    for (const std::uint32_t y : {2U, 3U}) {
      for (const std::uint32_t z : {4U, 5U}) {
        octahedron.triangles.push_back((x + y + z) % 2 == 0 ? Triangle{x, y, z} : Triangle{x, z, y});
      }
    }
  }
  const TriangleMesh box = box_mesh({-1, -1, -1}, {1, 1, 1});
  Random random(3);
  const TriangleMesh oriented = automatic(with_faces_reversed(joined(box, octahedron), random, 0.5));
  EXPECT_EQ(winding(oriented, {0.05, 0.03, 0.02}), 0);
  EXPECT_EQ(winding(oriented, {0.9, 0.9, 0.8}), 1);
}

// A box with a well of square section from its top down to z = 4, around x = y = 5.
TriangleMesh box_with_a_well(double lower, double upper, double half_width) {
  TriangleMesh mesh;
  const auto add_square = [&](double from, double to, double z) {
    for (const Vec3& p : {Vec3{from, from, z}, Vec3{to, from, z}, Vec3{to, to, z}, Vec3{from, to, z}})
      mesh.vertices.push_back(p);
  };
  add_square(lower, upper, lower);
  add_square(lower, upper, upper);
  add_square(5 - half_width, 5 + half_width, upper);
  add_square(5 - half_width, 5 + half_width, 4);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {12, 13, 14}, {12, 14, 15}};
  for (std::uint32_t ring = 0; ring < 12; ring += 4) {  // from one square to the next
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t a = ring + i, b = ring + (i + 1) % 4;
      mesh.triangles.push_back({a, b, b + 4});
      mesh.triangles.push_back({a, b + 4, a + 4});
    }
  }
  return mesh;
}

// The smallest box lies within the middle one, and that within the largest, but the smallest one in the well.
TEST(Orient, KeepsACavityThatTheNextButOneIsNotAround) {
  const TriangleMesh well = box_with_a_well(0, 10, 0.5), middle = box_mesh({3, 3, 3}, {7, 7, 7});
  const TriangleMesh mesh = joined(joined(well, middle), test::reversed(box_mesh({4.9, 4.9, 4.9}, {5.1, 5.1, 5.1})));
  EXPECT_EQ(orient(mesh, Orient::kAuto).counts.flipped_faces, 0U);
  EXPECT_EQ(winding(automatic(test::reversed(mesh)), {5.01, 5.02, 4.98}), 0);
}

// Two with wells are around the box in which the other two are, but around none of these.
TEST(Orient, AlternatesWithTheInnermostThoughFewAreAroundIt) {
  const TriangleMesh wells = joined(box_with_a_well(-1, 11, 0.4), test::reversed(box_with_a_well(0, 10, 0.5)));
  const TriangleMesh in_wells =
      joined(test::reversed(box_mesh({4.8, 4.8, 4.8}, {5.2, 5.2, 5.2})), box_mesh({4.9, 4.9, 4.9}, {5.1, 5.1, 5.1}));
  expect_restored(joined(joined(wells, box_mesh({3, 3, 3}, {7, 7, 7})), in_wells));
}

TEST(Orient, DecidesTheVolumeExactly) {
  // Thin beyond what doubles tell apart from flat.
  const double least = std::numeric_limits<double>::denorm_min();
  for (const double size : {1.0, 1e300, 1e-300}) {
    TriangleMesh sliver = box_mesh({size, size, 0}, {3 * size, 2 * size, least});
    expect_restored(sliver);
  }
}

TEST(Orient, TurnsAFlatClosedPatchByItsCoordinates) {
  const TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}}};
  EXPECT_TRUE(set_of_faces(automatic(flat)) == set_of_faces(automatic(test::reversed(flat))));
}

// ---- Edges of more than two faces ----

// The upper and the lower half of an octahedron share no edge with two faces: along each, a tetrahedron touches. Both
// outward within a sphere, they stay so, as the tetrahedra do.
TEST(Orient, JoinsPatchesThatCloseEachOther) {
  TriangleMesh mesh = joined(sphere_of(3), {{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {}});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size() - 6);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t a = first + i, b = first + (i + 1) % 4, top = first + 4, bottom = first + 5;
    const Vec3 out = 0.9 * (mesh.vertices[a] + mesh.vertices[b]);
    const auto up = static_cast<std::uint32_t>(mesh.vertices.size()), down = up + 1;
    mesh.vertices.push_back(out + Vec3{0, 0, 0.1});
    mesh.vertices.push_back(out - Vec3{0, 0, 0.1});
    for (const Triangle& t : {Triangle{a, b, top}, Triangle{b, a, bottom}, Triangle{a, up, b}, Triangle{a, b, down},
                              Triangle{a, down, up}, Triangle{b, up, down}}) {
      mesh.triangles.push_back(t);
    }
  }
  ASSERT_TRUE(mesh_statistics(mesh).closed());
  ASSERT_EQ(winding(mesh, {0.1, 0.1, 0.1}), 2);
  EXPECT_TRUE(set_of_faces(automatic(mesh)) == set_of_faces(mesh));
  EXPECT_TRUE(set_of_faces(automatic(test::reversed(mesh))) == set_of_faces(mesh));
  // With a fin at one of their edges, they and the fin do not close as stored; at other edges they close each other.
  mesh.triangles.push_back({first, first + 1, static_cast<std::uint32_t>(mesh.vertices.size())});
  mesh.vertices.push_back({1, 1, 0});
  EXPECT_EQ(winding(automatic(mesh), {0.1, 0.1, 0.1}), 2);
  EXPECT_EQ(winding(automatic(test::reversed(mesh)), {0.1, 0.1, 0.1}), 2);
}

TEST(Orient, RestoresCubesThatShareAnEdge) {
  expect_restored(welded(joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 1, 0}, {2, 2, 1}))));
}

TEST(Orient, RestoresCubesThatShareAVertex) {
  expect_restored(welded(joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 1, 1}, {2, 2, 2}))));
}

TEST(Orient, KeepsTheInsideOfCubesThatShareASide) {
  const TriangleMesh cubes = welded(joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 0, 0}, {2, 1, 1})));
  for (const TriangleMesh& other : damaged(cubes)) {
    const OrientedMesh oriented = orient(welded(other), Orient::kAuto);
    EXPECT_EQ(oriented.mesh.triangles.size(), 22U);  // of two sides in one place, one is left
    for (const Vec3& q : {Vec3{0.4, 0.5, 0.6}, Vec3{1.7, 0.4, 0.3}, Vec3{0.9, 0.1, 0.1}}) {
      EXPECT_GT(test::direct_winding_number(oriented.mesh, q), 0.5);
    }
    for (const Vec3& q : {Vec3{-0.1, 0.5, 0.6}, Vec3{2.1, 0.4, 0.3}, Vec3{1.01, 1.1, 0.5}}) {
      EXPECT_LT(test::direct_winding_number(oriented.mesh, q), 0.5);
    }
  }
}

// A box of unit squares, lower corner (l, l, l), two units long.
TriangleMesh box_of_squares(double l) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 8; ++i) {
      const bool upper = (i & 4) != 0;
      const auto corner = [&](double u, double v) {
        const std::array<double, 3> along{upper ? 2.0 : 0.0, (i & 1) + u, ((i >> 1) & 1) + v};
        const auto part = [&](int a) { return l + along[static_cast<std::size_t>((a - axis + 3) % 3)]; };
        mesh.vertices.push_back({part(0), part(1), part(2)});
      };
      const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) corner(u, v);
      for (Triangle t : {Triangle{n, n + 1, n + 2}, Triangle{n, n + 2, n + 3}}) {
        if (!upper) reverse(t);
        mesh.triangles.push_back(t);
      }
    }
  }
  return welded(mesh);
}

// Where the boxes pass through each other, their faces meet in fours. As the mean of both sides, 1/2 everywhere, it
// would be better to empty what is in both.
TEST(Orient, KeepsWhatClosesAsStoredAcrossEdgesOfFourFaces) {
  const TriangleMesh boxes = welded(joined(box_of_squares(0), box_of_squares(1)));
  ASSERT_EQ(winding(boxes, {1.4, 1.5, 1.6}), 2);
  for (const TriangleMesh& stored : {boxes, test::reversed(boxes)}) {
    EXPECT_EQ(set_of_faces(automatic(stored)), set_of_faces(boxes));
  }
}

// One face the other way round: the file is not to be trusted, and nothing is kept for its sake.
TEST(Orient, KeepsNothingAcrossEdgesOfFourFacesThatDoNotClose) {
  TriangleMesh boxes = welded(joined(box_of_squares(0), box_of_squares(1)));
  reverse(boxes.triangles.front());
  const TriangleMesh oriented = automatic(boxes);
  EXPECT_EQ(winding(oriented, {1.4, 1.5, 1.6}), 0);
  EXPECT_EQ(winding(oriented, {0.4, 0.5, 0.6}), 1);
  EXPECT_EQ(winding(oriented, {2.4, 2.5, 2.6}), 1);
}

TEST(Orient, RestoresCellsThatTouchInEdges) {
  Random random(11);
  for (int i = 0; i < 40; ++i) {
    const TriangleMesh cells = test::random_cells(random, 3);
    const TriangleMesh oriented = automatic(with_faces_reversed(cells, random, 0.5));
    EXPECT_EQ(oriented.triangles.size(), cells.triangles.size());
    int wrong = 0;
    for (int x = 0; x < 3; ++x) {
      for (int y = 0; y < 3; ++y) {
        for (int z = 0; z < 3; ++z) {
          const Vec3 q{x + 0.5, y + 0.5, z + 0.5};
          wrong += (test::direct_winding_number(oriented, q) >= 0.5) != (winding(cells, q) >= 1);
        }
      }
    }
    EXPECT_EQ(wrong, 0) << "mesh " << i;
  }
}

// ---- Open patches ----

TEST(Orient, TurnsAnOpenBowlSoThatItsHollowIsInside) {
  TriangleMesh half = sphere_of(1);
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return half.vertices[t[0]].z + half.vertices[t[1]].z + half.vertices[t[2]].z > 0;
  });
  expect_restored(half);
  expect_restored(test::open_box());
}

TEST(Orient, TurnsSeparatePiecesOfOneSurfaceAlike) {
  // The sides of a box that do not meet.
  expect_restored(test::shrunk_faces(box_mesh({0, 0, 0}, {1, 1, 1}), 0.9));
}

TEST(Orient, TurnsAHoleyHollowSphere) {
  Random random(5);
  TriangleMesh outer = sphere_of(1, {}, 10), inner = test::reversed(sphere_of(0.6, {}, 10));
  outer.triangles.erase(outer.triangles.begin() + 100, outer.triangles.begin() + 104);
  inner.triangles.erase(inner.triangles.begin() + 50, inner.triangles.begin() + 54);
  expect_restored(joined(outer, inner));
}

// Without the faces around one of its vertices.
TriangleMesh sphere_with_a_hole(double radius) {
  TriangleMesh sphere = sphere_of(radius, {}, 10);
  std::erase_if(sphere.triangles, [](const Triangle& t) { return std::ranges::count(t, 50U) > 0; });
  return sphere;
}

TEST(Orient, KeepsAClosedCavityInAnOpenBodyHollow) {
  const TriangleMesh body = sphere_with_a_hole(1);
  expect_restored(joined(body, test::reversed(sphere_of(0.5))));
  expect_restored(joined(test::reversed(sphere_of(0.5, {0.1, 0.2, 0})), body));
  // What lies in the cavity, closed or open, is turned with it.
  expect_restored(joined(joined(body, sphere_of(0.3)), test::reversed(sphere_of(0.6))));
  expect_restored(joined(joined(body, sphere_with_a_hole(0.3)), test::reversed(sphere_of(0.6))));
}

TEST(Orient, KeepsTheRelationOfAClosedPatchToAnOpenBody) {
  const TriangleMesh both_outward = joined(sphere_with_a_hole(1), sphere_of(0.5));
  EXPECT_EQ(set_of_faces(automatic(both_outward)), set_of_faces(both_outward));
  EXPECT_EQ(set_of_faces(automatic(test::reversed(both_outward))), set_of_faces(both_outward));
  for (const std::size_t face : {std::size_t{0}, both_outward.triangles.size() - 1}) {
    TriangleMesh broken = both_outward;
    reverse(broken.triangles[face]);
    EXPECT_LT(test::direct_winding_number(automatic(broken), {0.1, 0, 0}), 0.5) << face;
  }
}

TEST(Orient, TakesWhatIsPartlyInAnOpenBodyForNoCavity) {
  const TriangleMesh body = sphere_with_a_hole(1);
  expect_restored(joined(body, box_mesh({0.2, -0.1, -0.1}, {2, 0.1, 0.1})));
  expect_restored(joined(body, sphere_of(0.5, {2, 0, 0})));
}

TEST(Orient, TurnsManySeparateTriangles) {
  // More than the number of surfaces that each act on every sample.
  Random random(13);
  const TriangleMesh ball = sphere_of(1, {}, 24);
  TriangleMesh separate;
  for (const Triangle& t : ball.triangles) {
    auto [a, b, c] = corners_of(ball, t);
    for (Vec3* p : {&a, &b, &c}) *p = *p + 1e-3 * test::uniform_point(random, {{}, {1, 1, 1}});
    test::add_triangle(separate, a, b, c);
  }
  const TriangleMesh oriented = automatic(with_faces_reversed(separate, random, 0.5));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < separate.triangles.size(); ++i) wrong += oriented.triangles[i] != separate.triangles[i];
  EXPECT_EQ(wrong, 0U);
}

// All have one centre, which is a sample: no reach, however small, makes them far. That was looked for, without end.
TEST(Orient, TurnsManyTrianglesAroundOnePoint) {
  TriangleMesh mesh;
  for (int n = 1; n <= 600; ++n) {
    const double s = n;
    test::add_triangle(mesh, {-s, 0, s}, {0, s, -s}, {s, -s, 0});
    if (n % 3 == 0) reverse(mesh.triangles.back());
  }
  const TriangleMesh turned = automatic(mesh);
  ASSERT_EQ(turned.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(set_of_faces(automatic(turned)), set_of_faces(turned));
}

// ---- What has no orientation ----

TEST(Orient, CutsAMoebiusStripAcross) {
  TriangleMesh strip;
  constexpr int kParts = 40;
  const double pi = std::acos(-1.0);
  for (int i = 0; i < kParts; ++i) {
    const double turn = 2 * pi * i / kParts;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(turn / 2);
      strip.vertices.push_back({r * std::cos(turn), r * std::sin(turn), side * std::sin(turn / 2)});
    }
  }
  for (std::uint32_t i = 0; i < kParts; ++i) {
    const bool last = i + 1 == kParts;
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  const OrientedMesh oriented = orient(strip, Orient::kAuto);
  EXPECT_EQ(oriented.counts.cut_edges, 1U);  // the fewest
  EXPECT_EQ(oriented.counts.patches, 1U);
  Random random(2);
  EXPECT_EQ(set_of_faces(automatic(test::shuffled(strip, random))), set_of_faces(oriented.mesh));
}

TEST(Orient, TurnsNoFacesWithEqualCornersAndLeavesEachOnce) {
  TriangleMesh mesh = sphere_of(1);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({2, 2, 2});
  const OrientedMesh oriented = orient(mesh, Orient::kAuto);
  EXPECT_EQ(oriented.mesh.triangles, mesh.triangles);
  const TriangleMesh nothing{{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}};
  EXPECT_EQ(automatic(nothing).triangles, nothing.triangles);
  mesh.triangles.insert(mesh.triangles.end(), {{1, 0, 0}, {0, 1, 1}, {2, 2, 2}});
  const OrientedMesh once = orient(mesh, Orient::kAuto);
  EXPECT_EQ(once.counts.dropped_duplicates, 2U);
  mesh.triangles.resize(mesh.triangles.size() - 3);
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(once.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(automatic({}).triangles.empty());
}

TEST(Orient, FindsCopiesOfVerticesThatWereNotWelded) {
  TriangleMesh loose;
  for (const TriangleMesh ball = sphere_of(1); const Triangle& t : ball.triangles) {
    const auto [a, b, c] = corners_of(ball, t);
    test::add_triangle(loose, a, b, c);
  }
  Random random(4);
  const OrientedMesh oriented = orient(with_faces_reversed(loose, random, 0.5), Orient::kAuto);
  EXPECT_EQ(oriented.counts.patches, 1U);
  EXPECT_EQ(set_of_faces(oriented.mesh), set_of_faces(loose));
}

TEST(Orient, CountsWhatItDid) {
  Random random(6);
  TriangleMesh mesh = sphere_of(1);
  mesh.triangles.push_back(mesh.triangles[3]);
  reverse(mesh.triangles[5]);
  const OrientedMesh oriented = orient(mesh, Orient::kAuto);
  EXPECT_EQ(oriented.counts.flipped_faces, 1U);
  EXPECT_EQ(oriented.counts.dropped_duplicates, 1U);
  EXPECT_EQ(oriented.counts.patches, 1U);
  EXPECT_EQ(oriented.counts.cut_edges, 0U);
  // A copy that is stored as it should be is left: nothing is flipped.
  EXPECT_EQ(orient(welded(doubled(sphere_of(1), random)), Orient::kAuto).counts.flipped_faces, 0U);
}

// Cubes that share walls, each stored by both.
TriangleMesh cells(int count) {
  TriangleMesh mesh;
  for (int x = 0; x < count; ++x) {
    for (int y = 0; y < count; ++y) {
      const Vec3 lower{static_cast<double>(x), static_cast<double>(y), 0.0};
      mesh = joined(mesh, box_mesh(lower, lower + Vec3{1, 1, 1}));
    }
  }
  return welded(mesh);
}

TEST(Orient, CountsWhereWallsEnd) {
  Random random(7);
  EXPECT_EQ(orient(cells(1), Orient::kAuto).counts.wall_edges, 0U);
  // Of each of four walls, all edges but the one in the middle, where only walls meet.
  EXPECT_EQ(orient(cells(2), Orient::kAuto).counts.wall_edges, 12U);
  EXPECT_EQ(orient(test::shuffled(cells(2), random), Orient::kAuto).counts.wall_edges, 12U);
  EXPECT_EQ(orient(cells(2), Orient::kKeep).counts.wall_edges, 0U);
  // No face of these has an opinion: they are double-sided.
  EXPECT_EQ(orient(welded(doubled(sphere_of(1), random)), Orient::kAuto).counts.wall_edges, 0U);
  EXPECT_EQ(orient(welded(doubled(sphere_with_a_hole(1), random)), Orient::kAuto).counts.wall_edges, 0U);
  // One face that is double-sided, of a ball.
  TriangleMesh ball = sphere_of(1);
  ball.triangles.push_back(ball.triangles[3]);
  reverse(ball.triangles.back());
  EXPECT_EQ(orient(ball, Orient::kAuto).counts.wall_edges, 0U);
}

// ---- Any mesh ----

// Closed and open ones, some beside it, turned at random.
TriangleMesh balls_in_an_open_one(Random& random, int count) {
  TriangleMesh mesh = with_faces_reversed(sphere_with_a_hole(1), random, count % 2 == 0 ? 0.2 : 0.0);
  for (int i = 0; i < count; ++i) {
    const double radius = test::uniform(random, 0.05, 0.4);
    const Vec3 centre = test::uniform_point(random, {{-1, -1, -1}, {1, 1, 1}});
    TriangleMesh ball = sphere_of(radius, centre, 4);
    if (i % 3 == 0) ball.triangles.pop_back();
    if (i % 2 == 0) ball = test::reversed(ball);
    mesh = joined(mesh, with_faces_reversed(ball, random, i % 4 == 0 ? 0.2 : 0.0));
  }
  return mesh;
}

// Every kind of defect: faces that share edges, that are there often, that have no area.
TEST(Orient, DependsOnNeitherOrderNorThreads) {
  Random random(17);
  for (int i = 0; i < 60; ++i) {
    const TriangleMesh mesh = i % 4 == 0   ? test::soup(random, 1 + i)
                              : i % 4 == 1 ? test::lattice_soup(random, 1 + 3 * i, 3)
                              : i % 4 == 2 ? test::random_cells(random, 3)
                                           : balls_in_an_open_one(random, i / 4);
    if (mesh.triangles.empty()) continue;
    const OrientedMesh expected = orient(mesh, Orient::kAuto);
    for (int j = 0; j < 3; ++j) {
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, j == 0 ? 1 : 8);
      const OrientedMesh other = orient(test::shuffled(mesh, random), Orient::kAuto);
      ASSERT_TRUE(set_of_faces(other.mesh) == set_of_faces(expected.mesh)) << "mesh " << i;
      EXPECT_EQ(other.counts.flipped_faces, expected.counts.flipped_faces);
      EXPECT_EQ(other.counts.dropped_duplicates, expected.counts.dropped_duplicates);
      EXPECT_EQ(other.counts.patches, expected.counts.patches);
      EXPECT_EQ(other.counts.cut_edges, expected.counts.cut_edges);
    }
  }
}

// Next to a triangle of size 1, these have lost much of their shape, or all of it.
TEST(Orient, DependsOnNoOrderInPiecesThatAreTooSmall) {
  Random random(23);
  const TriangleMesh far{{{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}, {{0, 1, 2}}};
  for (const double size : {1e-14, 1e-15, 3e-16, 1e-16, 1e-17, 1e-20}) {
    for (const Vec3& f : {Vec3{size, size, size}, Vec3{0.5, 0.5, size}, Vec3{size, 0.5, 0.5}, Vec3{size, size, 0.5}}) {
      TriangleMesh mesh = far;
      for (const TriangleMesh& shape : {test::open_box(), sphere_with_a_hole(1), test::lattice_soup(random, 60, 3)}) {
        const double x = test::uniform(random, -3, 3);
        const TriangleMesh small = test::moved(shape, f, {x * f.x, -0.3 * f.y, 0.4 * f.z});
        mesh = joined(mesh, with_faces_reversed(small, random, 0.3));
      }
      const auto expected = set_of_faces(automatic(mesh));
      for (int i = 0; i < 5; ++i) {
        const TriangleMesh other = test::shuffled(with_faces_reversed(mesh, random, 0.5), random);
        ASSERT_TRUE(set_of_faces(automatic(other)) == expected) << size << " " << i;
      }
    }
  }
}

TEST(Orient, IsTheSameAtEveryMagnitude) {
  const TriangleMesh mesh = joined(joined(sphere_of(1), test::open_box()), sphere_of(0.5, {3, 0, 0}));
  Random random(19);
  const TriangleMesh turned = with_faces_reversed(mesh, random, 0.5);
  const std::vector<Triangle> expected = automatic(turned).triangles;
  for (const double size : {0x1p1000, 0x1p-1000, 0x1p-40}) {
    EXPECT_EQ(automatic(test::moved(turned, {size, size, size}, {})).triangles, expected) << size;
  }
  for (const double huge : {1e308, 1e300}) {
    const TriangleMesh wide{{{-huge, 0, 0}, {huge, 0, 1e-300}, {0, huge, 0}, {0, 0, huge}}, {{0, 1, 2}, {3, 1, 0}}};
    EXPECT_EQ(automatic(wide).triangles.size(), 2U);
  }
}

// What the triangles of a mesh, each alone, do at points spread evenly over all of them: on one itself the mean of its
// two sides is 0.
struct EffectsAtPoints {
  std::vector<double> area;                 // that a point stands for
  std::vector<std::vector<double>> effect;  // of each triangle, at each point

  explicit EffectsAtPoints(const TriangleMesh& mesh) : effect(mesh.triangles.size()) {
    constexpr int kSteps = 16;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      const Vec3 a = mesh.vertices[t[0]], ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a;
      for (int n = 0; n < kSteps * kSteps; ++n) {
        double u = (n % kSteps + 0.5) / kSteps, v = (n / kSteps + 0.5) / kSteps;
        if (u + v > 1.0) std::tie(u, v) = std::pair(1.0 - u, 1.0 - v);
        area.push_back(norm(cross(ab, ac)) / (2 * kSteps * kSteps));
        add_effects(mesh, a + u * ab + v * ac, f);
      }
    }
  }

  void add_effects(const TriangleMesh& mesh, const Vec3& at, std::size_t own) {
    for (std::size_t f = 0; f < effect.size(); ++f) {
      const TriangleMesh alone{mesh.vertices, {mesh.triangles[f]}};
      effect[f].push_back(f == own ? 0.0 : test::direct_winding_number(alone, at));
    }
  }

  // `reversed`: the triangles that are turned, as bits.
  [[nodiscard]] double sum(unsigned reversed) const {
    double sum = 0;
    for (std::size_t point = 0; point < area.size(); ++point) {
      double mean = 0;
      for (std::size_t f = 0; f < effect.size(); ++f) mean += (reversed >> f & 1 ? -1 : 1) * effect[f][point];
      sum += area[point] * (mean - 0.5) * (mean - 0.5);
    }
    return sum;
  }
};

// The least sum over all choices of signs, by the definition of the winding number on both sides of each face.
TEST(Orient, FindsTheBestOrientationOfAFewOpenPatches) {
  Random random(23);
  int best = 0;
  constexpr int kMeshes = 30;
  for (int i = 0; i < kMeshes; ++i) {
    const TriangleMesh mesh = test::soup(random, 6);
    const EffectsAtPoints effects(mesh);
    double least = std::numeric_limits<double>::infinity();
    for (unsigned choice = 0; choice < 64; ++choice) least = std::min(least, effects.sum(choice));
    const TriangleMesh turned = automatic(mesh);
    unsigned choice = 0;
    for (unsigned f = 0; f < 6; ++f) choice |= (turned.triangles[f] == mesh.triangles[f] ? 0U : 1U) << f;
    const double found = effects.sum(choice);
    best += found < least * 1.0001;
    EXPECT_LT(found, 1.1 * least + 1e-3) << "mesh " << i;
  }
  EXPECT_GE(best, kMeshes * 9 / 10);
}

// The middles of the sides are in spheres, where all seems inside: by them alone, the box is inside out.
TEST(Orient, LooksAtMoreThanTheMiddleOfALargeFace) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh mesh;
  for (const Triangle& t : box.triangles) {
    const TriangleMesh side{{box.vertices[t[0]], box.vertices[t[1]], box.vertices[t[2]]}, {{0, 1, 2}}};
    const Vec3 middle = (1.0 / 3) * (side.vertices[0] + side.vertices[1] + side.vertices[2]);
    mesh = joined(mesh, test::moved(side, {0.9, 0.9, 0.9}, 0.1 * middle));
    mesh = joined(mesh, sphere_of(0.05, middle));
  }
  expect_restored(mesh);
}

}  // namespace
}  // namespace raycone
