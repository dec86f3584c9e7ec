// Reversed components, inconsistent edges and faces that cancel: meshes that have them, and near misses.
#include "core/orientation/mesh_defects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/weld.h"
#include "tests/support/shapes.h"

namespace raycone::test {
namespace {

const TriangleMesh kCubeMesh = box_mesh({0, 0, 0}, {1, 1, 1});

MeshDefects defects_of(const TriangleMesh& mesh) {
  const TriangleMesh welded = weld(mesh, {});
  VertexLinks links(welded.vertices.size());
  const std::vector<ExteriorEdge> edges = exterior_edges(welded, &links);
  return mesh_defects(welded, edges, links);
}

std::uint64_t reversed_in(const TriangleMesh& mesh) { return defects_of(mesh).reversed_components; }

TriangleMesh cube_at(double lower, double upper) { return box_mesh({lower, lower, lower}, {upper, upper, upper}); }

void expect_none(const TriangleMesh& mesh) {
  const MeshDefects defects = defects_of(mesh);
  EXPECT_EQ(defects.inconsistent_edges, 0U);
  EXPECT_EQ(defects.cancelling_pairs, 0U);
  EXPECT_EQ(defects.reversed_components, 0U);
  EXPECT_FALSE(defects.negative_volume);
}

TEST(MeshDefects, AreAbsentFromGoodMeshes) {
  expect_none({});
  expect_none(kCubeMesh);
  expect_none(sphere(20));
  expect_none(open_box());
  expect_none(reversed(open_box()));  // open: the volume is that of nothing
  expect_none(joined(kCubeMesh, cube_at(3, 4)));
}

TEST(MeshDefects, ClosedMeshOfNegativeVolumeIsReversed) {
  const MeshDefects defects = defects_of(reversed(kCubeMesh));
  EXPECT_EQ(defects.reversed_components, 1U);
  EXPECT_TRUE(defects.negative_volume);
}

// Around a square on a slope whose corners are off it by a rounding error or two: volumes of 0 but for such.
TriangleMesh sliver(double height) {
  return {{{0, 0, 0.1}, {1, 0, 0.4}, {1, 1, 0.9 + height}, {0, 1, 0.6}}, {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}}};
}

TEST(MeshDefects, SignOfATinyVolumeIsExact) {
  // The diagonal through the raised corner is above the other one: the front of the upper faces is up.
  for (const double height : {0x1p-50, 0x1p-40, -0x1p-50, -0x1p-40}) {
    const auto below = static_cast<std::uint64_t>(height < 0);
    EXPECT_EQ(reversed_in(sliver(height)), below) << height;
    EXPECT_EQ(reversed_in(reversed(sliver(height))), 1 - below) << height;
    EXPECT_EQ(reversed_in(joined(cube_at(5, 6), sliver(height))), below) << height;
    EXPECT_EQ(defects_of(sliver(height)).negative_volume, height < 0) << height;
  }
  EXPECT_EQ(reversed_in(joined(sliver(0x1p-50), reversed(sliver(0x1p-50)))), 0U) << "they cancel";
}

TEST(MeshDefects, OneOfTwoSolidsMayBeReversed) {
  const MeshDefects defects = defects_of(joined(cube_at(0, 4), reversed(cube_at(5, 6))));
  EXPECT_EQ(defects.reversed_components, 1U);
  EXPECT_FALSE(defects.negative_volume);
  EXPECT_EQ(reversed_in(joined(reversed(cube_at(0, 1)), reversed(cube_at(5, 6)))), 2U);
}

Vec3 unit(const Vec3& v) { return (1.0 / norm(v)) * v; }
Vec3 direction(Random& random) {
  return unit({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
}

TEST(MeshDefects, WhatHasNoSizeIsNotLookedAtInParts) {
  EXPECT_EQ(reversed_in(joined(box_mesh({-1, -1, 0}, {1, 1, 1}), reversed(cube_at(0, 5e-324)))), 0U);
}

TEST(MeshDefects, CavityIsNotReversed) {
  expect_none(joined(cube_at(0, 4), reversed(cube_at(1, 2))));
  expect_none(joined(cube_at(0, 4), joined(reversed(cube_at(1, 3)), cube_at(1.5, 2.5))));
  // Nor is it where it touches the wall from within, at no common vertex.
  expect_none(joined(cube_at(0, 4), reversed(box_mesh({0, 1, 1}, {2, 2, 2}))));
  expect_none(joined(cube_at(0, 4), reversed(box_mesh({2, 1, 1}, {4, 2, 2}))));
}

TEST(MeshDefects, ReversedSolidBesideAWallIsReversed) {
  // The first touches the cube from outside, the others are level with it.
  EXPECT_EQ(reversed_in(joined(cube_at(0, 4), reversed(box_mesh({4, 1, 1}, {6, 2, 2})))), 1U);
  EXPECT_EQ(reversed_in(joined(cube_at(0, 4), reversed(box_mesh({-6, 1, 1}, {-5, 2, 2})))), 1U);
  EXPECT_EQ(reversed_in(joined(cube_at(0, 4), reversed(box_mesh({-6, 0, 0}, {-5, 2, 2})))), 1U);
}

// With its axes in another order, and mirrored or not, but facing as before.
TriangleMesh turned(TriangleMesh mesh, const std::array<int, 3>& axes, double sign) {
  for (Vec3& p : mesh.vertices) p = sign * Vec3{p[axes[0]], p[axes[1]], p[axes[2]]};
  const bool is_even = (axes[1] - axes[0] + 3) % 3 == 1;
  return is_even == (sign > 0) ? mesh : reversed(mesh);
}

// Of a mesh in all these positions.
void expect_reversed_in_any_position(const TriangleMesh& mesh, std::uint64_t expected) {
  std::array axes{0, 1, 2};
  do {
    for (const double sign : {1.0, -1.0}) {
      EXPECT_EQ(reversed_in(turned(mesh, axes, sign)), expected) << axes[0] << axes[1] << axes[2] << ' ' << sign;
    }
  } while (std::ranges::next_permutation(axes).found);
}

// A cone of negative volume, from a ring around z at the height z to `apex`.
TriangleMesh reversed_cone(std::uint32_t corners, double z, const Vec3& apex) {
  TriangleMesh cone{{apex}, {}};
  for (std::uint32_t n = 0; n < corners; ++n) {
    const double angle = 2 * std::numbers::pi * n / corners;
    cone.vertices.push_back({5 + 2 * std::cos(angle), 5 + 2 * std::sin(angle), z});
    const std::uint32_t from = n + 1, to = (n + 1) % corners + 1;
    cone.triangles.push_back({0, to, from});
    if (n > 0 && n + 1 < corners) cone.triangles.push_back({1, from, to});
  }
  return apex.z > z ? cone : reversed(cone);
}

// Neither its first vertices nor these moved by the perturbation tell: they move along the wall or past it.
TEST(MeshDefects, WhatTouchesAWallIsWhereTheRestOfItIs) {
  const TriangleMesh room = cube_at(0, 10);
  for (const std::uint32_t corners : {3U, 4U, 5U, 40U}) {
    expect_reversed_in_any_position(reversed_cone(corners, 0, {9, 5, -3}), 1);
    expect_reversed_in_any_position(joined(room, reversed_cone(corners, 0, {9, 5, -3})), 1);
    expect_reversed_in_any_position(joined(room, reversed_cone(corners, 0, {9, 5, 3})), 0);
    expect_reversed_in_any_position(joined(room, reversed_cone(corners, 10, {9, 5, 13})), 1);
    expect_reversed_in_any_position(joined(room, reversed_cone(corners, 10, {9, 5, 7})), 0);
  }
  // From the ceiling by its first vertex alone, and up to the floor from below.
  const std::vector<Triangle> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  expect_reversed_in_any_position(joined(room, {{{1, 5, 10}, {8, 1, 5}, {9, 5, 3}, {8, 9, 5}}, faces}), 0);
  expect_reversed_in_any_position(joined(room, {{{1, 5, 0}, {8, 9, -5}, {9, 5, -3}, {8, 1, -5}}, faces}), 1);
}

TEST(MeshDefects, CavityMayTouchItsWallsWithAllVertices) {
  TriangleMesh octahedron{{{0, 5, 5}, {10, 5, 5}, {5, 0, 5}, {5, 10, 5}, {5, 5, 0}, {5, 5, 10}}, {}};
  for (const std::uint32_t x : {0U, 1U}) {
    for (const std::uint32_t y : {2U, 3U}) {
      for (const std::uint32_t z : {4U, 5U}) {
        const bool faces_inward = (x + y + z) % 2 == 0;
        octahedron.triangles.push_back(faces_inward ? Triangle{x, y, z} : Triangle{x, z, y});
      }
    }
  }
  EXPECT_EQ(reversed_in(octahedron), 1U);
  EXPECT_EQ(reversed_in(joined(cube_at(0, 10), octahedron)), 0U);
}

// However it lies: rounding moves the corners of the hole off the walls.
TEST(MeshDefects, HoleDrilledThroughIsACavity) {
  const TriangleMesh drilled = joined(cube_at(0, 4), reversed(box_mesh({1, 1, 0}, {2, 2, 4})));
  expect_none(drilled);
  Random random(5);
  for (int n = 0; n < 40; ++n) {
    const Vec3 x = direction(random), z = unit(cross(x, direction(random))), y = cross(z, x);
    TriangleMesh turned = drilled;
    for (Vec3& p : turned.vertices) {
      p = p.x * x + p.y * y + p.z * z;
      if (n % 2 == 1) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    }
    EXPECT_EQ(reversed_in(turned), 0U) << n;
    EXPECT_EQ(reversed_in(reversed(turned)), 1U) << n;
  }
  const TriangleMesh tetrahedron{{{0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {0, 2, 2}},
                                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  EXPECT_EQ(reversed_in(tetrahedron) + reversed_in(reversed(tetrahedron)), 1U);
  const TriangleMesh& cavity = reversed_in(tetrahedron) == 1 ? tetrahedron : reversed(tetrahedron);
  EXPECT_EQ(reversed_in(joined(cube_at(0, 4), cavity)), 0U) << "all its vertices are on the walls";
}

// Between the squares [0, 10]^2 and [2, 8]^2, of that thickness.
TriangleMesh picture_frame(double thickness) {
  TriangleMesh frame;
  for (const double z : {0.0, thickness}) {
    for (const double margin : {0.0, 2.0}) {
      const double low = margin, high = 10 - margin;
      frame.vertices.insert(frame.vertices.end(), {{low, low, z}, {high, low, z}, {high, high, z}, {low, high, z}});
    }
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    frame.triangles.insert(frame.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    quad(i, j, j + 8, i + 8);            // outside
    quad(j + 4, i + 4, i + 12, j + 12);  // the opening's
    quad(i + 8, j + 8, j + 12, i + 12);  // above
    quad(j, i, i + 4, j + 4);            // below
  }
  return frame;
}

// Its ends are within the frame, so all its vertices are.
TEST(MeshDefects, BarAcrossTheOpeningOfAFrameIsNoCavity) {
  const TriangleMesh frame = picture_frame(4);
  expect_none(frame);
  expect_reversed_in_any_position(joined(frame, reversed(box_mesh({4, 1, 1}, {6, 9, 3}))), 1);
  expect_reversed_in_any_position(joined(frame, reversed(box_mesh({0.5, 1, 1}, {1.5, 9, 3}))), 0);
}

// In the notch of an L, with all its vertices on the walls there.
TEST(MeshDefects, WhatFillsANotchIsNoCavity) {
  const TriangleMesh l = joined(box_mesh({5, 0, 0}, {10, 5, 10}), box_mesh({0, 5, 0}, {10, 10, 10}));
  const TriangleMesh wedge{{{1, 5, 1}, {2, 5, 9}, {5, 1, 2}, {5, 3, 8}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  const TriangleMesh& negative = reversed_in(wedge) == 1 ? wedge : reversed(wedge);
  expect_reversed_in_any_position(joined(l, negative), 1);
}

TEST(MeshDefects, CoincidentReversedSolidsAreNotWithinEachOther) {
  TriangleMesh mesh = joined(cube_at(0, 5), reversed(cube_at(10, 11)));
  for (const std::uint32_t v : std::vector<std::uint32_t>{8, 9, 10, 11, 12, 13, 14, 15}) {
    mesh.vertices.push_back(mesh.vertices[v]);  // not welded
  }
  for (std::size_t n = 12; n < 24; ++n) {
    const Triangle t = mesh.triangles[n];
    mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  }
  VertexLinks links(mesh.vertices.size());
  EXPECT_EQ(mesh_defects(mesh, exterior_edges(mesh, &links), links).reversed_components, 2U);
}

// Joined through that vertex they have a negative volume.
TEST(MeshDefects, CavityMayTouchASolidOutsideAtAVertex) {
  const TriangleMesh room = cube_at(0, 10);
  const std::vector<Triangle> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 3, 2}, {1, 4, 3}};
  const TriangleMesh inner{{{0, 5, 4}, {5, 3, 2}, {5, 7, 2}, {5, 7, 6}, {5, 3, 6}}, faces};
  const TriangleMesh outer{{{0, 5, 4}, {-1, 4, 3}, {-1, 4, 5}, {-1, 6, 5}, {-1, 6, 3}}, faces};
  const auto facing = [](const TriangleMesh& mesh, std::uint64_t negative) {
    return reversed_in(mesh) == negative ? mesh : reversed(mesh);
  };
  expect_none(joined(room, joined(facing(inner, 1), facing(outer, 0))));
  EXPECT_EQ(reversed_in(joined(room, joined(facing(inner, 1), facing(outer, 1)))), 1U);
}

// One of 64 boxes holds another one, but no strand lies within another. A second or two; the limit is for sanitizers on
// busy machines.
TEST(MeshDefects, ReversedStrandsTakeNoLongTime) {
  Random random(41);
  TriangleMesh strands;
  for (int n = 0; n < 5'000; ++n) {
    const Vec3 low{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
    const Vec3 high{uniform(random, 9, 10), uniform(random, 9, 10), uniform(random, 9, 10)};
    const auto first = static_cast<std::uint32_t>(strands.vertices.size());
    for (const Vec3& p : {low, low + Vec3{1e-3, 0, 0}, low + Vec3{0, 1e-3, 0}, high}) strands.vertices.push_back(p);
    for (const Triangle& t : {Triangle{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}) {
      strands.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  const std::clock_t begin = std::clock();
  EXPECT_EQ(reversed_in(strands), 5'000U);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 20.0);
}

TEST(MeshDefects, WhollyReversedHollowSolidIsReversedOnce) {
  const MeshDefects defects = defects_of(reversed(joined(cube_at(0, 4), reversed(cube_at(1, 2)))));
  EXPECT_EQ(defects.reversed_components, 1U);
  EXPECT_TRUE(defects.negative_volume);
}

TEST(MeshDefects, ClosedComponentOfAnOpenMeshMayBeReversed) {
  EXPECT_EQ(reversed_in(joined(open_box(), reversed(cube_at(5, 6)))), 1U);
  EXPECT_FALSE(defects_of(joined(open_box(), reversed(cube_at(5, 6)))).negative_volume);
  EXPECT_EQ(reversed_in(joined(open_box(), reversed(cube_at(0.25, 0.5)))), 1U) << "what is open surrounds nothing";
}

TEST(MeshDefects, InconsistentAreTwoFacesAlongAnEdge) {
  EXPECT_EQ(defects_of(fan(2, 2)).inconsistent_edges, 1U);
  EXPECT_EQ(defects_of(fan(2, 1)).inconsistent_edges, 0U);
  EXPECT_EQ(defects_of(fan(4, 3)).inconsistent_edges, 0U) << "the same net count, of more faces";
  TriangleMesh flipped = kCubeMesh;
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(defects_of(flipped).inconsistent_edges, 3U);
}

TEST(MeshDefects, OppositeFacesCancelInPairs) {
  const MeshDefects doubled = defects_of(joined(kCubeMesh, reversed(kCubeMesh)));
  EXPECT_EQ(doubled.cancelling_pairs, 12U);
  EXPECT_EQ(doubled.reversed_components, 0U) << "the volume is 0";
  EXPECT_EQ(doubled.inconsistent_edges, 0U);
  EXPECT_EQ(defects_of(joined(kCubeMesh, kCubeMesh)).cancelling_pairs, 0U) << "these do not cancel";
  const Triangle t{0, 1, 2}, turned{1, 2, 0}, opposite{0, 2, 1}, segment{0, 1, 1}, segment_back{1, 0, 1};
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(defects_of({corners, {t, opposite, turned}}).cancelling_pairs, 1U);
  EXPECT_EQ(defects_of({corners, {t, opposite, turned, opposite, opposite}}).cancelling_pairs, 2U);
  EXPECT_EQ(defects_of({corners, {segment, segment_back}}).cancelling_pairs, 0U) << "they have no orientation";
}

TEST(MeshDefects, AreThoseOfAnyScaleAndSignOfZero) {
  for (const double scale : {1e-320, 1e-300, 1e-100, 1e100, 1e307}) {
    const Vec3 factors{scale, scale, scale};
    EXPECT_EQ(reversed_in(moved(reversed(sphere(8)), factors, {0, 0, 0})), 1U) << scale;
    expect_none(moved(sphere(8), factors, {0, 0, 0}));
  }
  EXPECT_EQ(reversed_in(moved(reversed(kCubeMesh), {1, 1, 1}, {1e12, -1e12, 1e12})), 1U);
  TriangleMesh zeros = reversed(kCubeMesh);
  for (Vec3& v : zeros.vertices) v = {v.x == 0 ? -0.0 : v.x, v.y == 0 ? -0.0 : v.y, v.z};
  EXPECT_EQ(defects_of(joined(kCubeMesh, zeros)).cancelling_pairs, 12U);
}

// Products of y and z are rounded to a few units of what is left of doubles there.
TEST(MeshDefects, SignOfAVolumeIsExactWhereProductsUnderflow) {
  Random random(31);
  int reversed_ones = 0;
  for (int n = 0; n < 200; ++n) {
    const auto number = [&] { return std::floor(uniform(random, -20, 20)); };
    TriangleMesh tetrahedron{{}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    for (int corner = 0; corner < 4; ++corner) tetrahedron.vertices.push_back({number(), number(), number()});
    const auto expected = reversed_in(tetrahedron);
    EXPECT_EQ(reversed_in(moved(tetrahedron, {0x1p600, 0x1p-539, 0x1p-539}, {})), expected) << "mesh " << n;
    EXPECT_EQ(reversed_in(moved(tetrahedron, {0x1p-539, 0x1p600, 0x1p-539}, {})), expected) << "mesh " << n;
    reversed_ones += static_cast<int>(expected);
  }
  EXPECT_GT(reversed_ones, 60);
}

// The marks of a vertex of many faces are all set; every second triangle of a fan is there the other way round.
TEST(MeshDefects, OppositeFacesAreFoundAtVerticesOfManyFaces) {
  Random random(37);
  for (const std::uint32_t faces : {1U, 7U, 8U, 9U, 40U}) {
    TriangleMesh fan_of_many;
    for (std::uint32_t v = 0; v <= faces + 1; ++v) fan_of_many.vertices.push_back({1.0 * v, 1.0 * v * v, 1});
    std::uint64_t pairs = 0;
    for (std::uint32_t v = 1; v <= faces; ++v) {
      fan_of_many.triangles.push_back({0, v, v + 1});
      if (v % 2 == 0) continue;
      fan_of_many.triangles.push_back({v + 1, v, 0});
      ++pairs;
    }
    EXPECT_EQ(defects_of(shuffled(fan_of_many, random)).cancelling_pairs, pairs) << faces;
  }
}

TEST(MeshDefects, OfManySolidsAreCountedOneByOne) {
  TriangleMesh mesh;
  std::uint64_t expected = 0;
  for (int n = 0; n < 8 * 8 * 8; ++n) {
    const Vec3 at{2.0 * (n % 8), 2.0 * (n / 8 % 8), 2.0 * (n / 64)};
    const auto box = [&](double margin) {
      const Vec3 in{margin, margin, margin};
      return box_mesh(at + in, at + Vec3{1, 1, 1} - in);
    };
    // Right, reversed, hollow, and hollow but wholly reversed ones.
    const bool is_reversed = n % 4 == 1 || n % 4 == 3;
    TriangleMesh solid = n % 4 < 2 ? box(0) : joined(box(0), reversed(box(0.25)));
    mesh = joined(mesh, is_reversed ? reversed(solid) : solid);
    expected += is_reversed;
  }
  EXPECT_EQ(reversed_in(mesh), expected);
}

// Minutes, if each looked at all others that its ray passes.
TEST(MeshDefects, RowsOfReversedSolidsTakeNoLongTime) {
  constexpr std::uint32_t kCount = 40'000;
  TriangleMesh row;
  for (std::uint32_t n = 0; n < kCount; ++n) {
    const double x = n;
    row.vertices.insert(row.vertices.end(), {{x, 0, 0}, {x + 0.5, 0, 0}, {x, 0.5, 0}, {x, 0, 0.5}});
    const std::uint32_t v = 4 * n;
    row.triangles.insert(row.triangles.end(),
                         {{v, v + 1, v + 2}, {v, v + 2, v + 3}, {v, v + 3, v + 1}, {v + 1, v + 3, v + 2}});
  }
  EXPECT_EQ(reversed_in(row), kCount);
  EXPECT_EQ(reversed_in(reversed(row)), 0U);
}

TEST(MeshDefects, OfSolidsAtBothEndsOfDoublePrecisionAreCounted) {
  TriangleMesh mesh;
  for (const double at : {-1.5e308, 0.0, 1.5e308}) {
    mesh = joined(mesh, reversed(box_mesh({at, at, at}, Vec3{at, at, at} + Vec3{1e307, 1e307, 1e307})));
  }
  EXPECT_EQ(reversed_in(mesh), 3U);
  for (Vec3& p : mesh.vertices) p = 0x1p-1023 * p;  // down to where nearly all bits are lost
  EXPECT_EQ(reversed_in(mesh), 3U);
}

// Concentric boxes around a center, of which every second one is reversed, from the first or second one on, or all are.
TriangleMesh shells(const Vec3& center, double size, int count, const std::function<bool(int)>& is_reversed) {
  TriangleMesh mesh;
  for (int n = 0; n < count; ++n) {
    const double half = size * (1.0 - 0.5 * n / count);
    const TriangleMesh shell = box_mesh(center - Vec3{half, half, half}, center + Vec3{half, half, half});
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), shell.vertices.begin(), shell.vertices.end());
    for (Triangle t : shell.triangles) {
      for (std::uint32_t& corner : t) corner += first;
      if (is_reversed(n)) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

TEST(MeshDefects, OfManyShellsWithinEachOtherOnlyTheOutermostMayBeReversed) {
  for (const int first_reversed : {0, 1}) {
    const TriangleMesh mesh = shells({0, 0, 0}, 2, 1100, [&](int n) { return n % 2 == first_reversed; });
    EXPECT_EQ(reversed_in(mesh), first_reversed == 0 ? 1U : 0U);
  }
}

// Each of them crosses the rays of all that are within it: a minute, if all of them were looked at. Large ones and
// small ones, so that settling the small ones has to wait for the first of them.
TEST(MeshDefects, ManyReversedShellsTakeNoLongTime) {
  const auto always = [](int) { return true; };
  const TriangleMesh large = shells({0, 0, 0}, 100, 6000, always), small = shells({300, 0, 0}, 1, 6000, always);
  const double before = static_cast<double>(std::clock());
  EXPECT_EQ(reversed_in(joined(large, small)), 2U);
  EXPECT_EQ(reversed_in(joined(small, large)), 2U);
  EXPECT_LT((static_cast<double>(std::clock()) - before) / CLOCKS_PER_SEC, 20.0);  // sanitizers, busy machines included
}

TEST(MeshDefects, DoNotDependOnTheOrderOfFaces) {
  Random random(7);
  const TriangleMesh mesh =
      joined(joined(cube_at(0, 4), reversed(cube_at(1, 2))), joined(reversed(cube_at(5, 6)), reversed(sphere(6))));
  const MeshDefects defects = defects_of(mesh);
  for (int n = 0; n < 20; ++n) {
    const MeshDefects other = defects_of(shuffled(mesh, random));
    EXPECT_EQ(other.reversed_components, defects.reversed_components);
    EXPECT_EQ(other.cancelling_pairs, defects.cancelling_pairs);
  }
}

}  // namespace
}  // namespace raycone::test
