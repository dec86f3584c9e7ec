// Whether a surface is closed, embedded and right at each node, at once and change by change.
#include "core/certificate/certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/contour/contour.h"
#include "core/machine/floating_point.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::compacted;
using test::kSurfaceMargin;
using test::lattice_off_origin;
using test::misplaced;
using test::nodes_where;
using test::Random;
using test::random_edge_points;
using test::random_face_points;
using test::uniform;
using test::without_gone;

// Some vertices move by up to a distance along each axis; or one is pulled into a neighbour, whatever comes of it.
SurfaceEdit random_change(const TriangleMesh& mesh, Random& random, bool pull, double most) {
  SurfaceEdit change;
  const auto any = [&](std::size_t count) {
    return static_cast<std::uint32_t>(uniform(random, 0.0, static_cast<double>(count)));
  };
  const Triangle& at = mesh.triangles[any(mesh.triangles.size())];
  const std::uint32_t u = at[0], v = at[1];
  const auto moved = [&](const Vec3& p) {
    return p + Vec3{uniform(random, -most, most), uniform(random, -most, most), uniform(random, -most, most)};
  };
  const bool to_another = !pull && uniform(random, 0.0, 1.0) < 0.2;
  change.vertices = {u};
  change.places = {{mesh.vertices[u], to_another ? mesh.vertices[v] : moved(mesh.vertices[u])}};
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const Triangle& before = mesh.triangles[face];
    Triangle after = before;
    if (pull) std::ranges::replace(after, v, u);
    if (std::ranges::count(after, u) == 2) after.fill(u);
    if (std::ranges::find(after, u) == after.end()) continue;
    change.faces.push_back(face);
    change.corners.push_back({before, after});
  }
  return change;
}

// The certificate has to see what is wrong.
TEST(SurfaceCertificate, FindsEachFault) {
  Random random(3);
  const DefaultFloatingPoint guard;
  const NodeSet nodes = nodes_where(lattice_off_origin(5), [](auto i, auto j, auto k) { return i + j + k < 6; });
  const SurfaceCells cells(nodes);
  const SurfaceMesh surface =
      contour({cells, random_edge_points(cells, random, true), {}, 0.0, kSurfaceMargin}, {}).surface;
  ASSERT_TRUE(faults_of(surface.mesh, nodes).none());
  TriangleMesh open = surface.mesh;
  open.triangles.pop_back();
  EXPECT_EQ(faults_of(open, nodes).edges, 3U);
  EXPECT_GT(faults_of(open, nodes).links, 0U);
  EXPECT_GT(faults_of(test::reversed(surface.mesh), nodes).nodes, 0U);
  TriangleMesh twice = surface.mesh;
  twice.vertices.push_back(twice.vertices[0]);
  EXPECT_EQ(faults_of(twice, nodes).equal_vertices, 1U);
  TriangleMesh pierced = surface.mesh;
  pierced.vertices[0] = pierced.vertices[0] + Vec3{7.0, 7.0, 7.0};
  EXPECT_GT(faults_of(pierced, nodes).intersections.pairs, 0U);
  TriangleMesh pinched = surface.mesh;
  const auto last = static_cast<std::uint32_t>(pinched.vertices.size() - 1);
  for (Triangle& t : pinched.triangles) std::ranges::replace(t, last, 0U);
  EXPECT_GT(faults_of(pinched, nodes).links + faults_of(pinched, nodes).edges, 0U);
}

// Vertices move to random places, or into a neighbour. What is found near them is right if all is, and is looked for
// only there.
TEST(SurfaceCertificate, FindsFaultsNearAChange) {
  Random random(5);
  const DefaultFloatingPoint guard;
  const Lattice lattice = lattice_off_origin(8);
  int right = 0, wrong = 0;
  for (int round = 0; round < 400; ++round) {
    const NodeSet nodes = nodes_where(lattice, [&](auto i, auto j, auto k) { return i + j + k < 9 + round % 4; });
    const SurfaceCells cells(nodes);
    TriangleMesh mesh =
        contour({cells, random_edge_points(cells, random, false), {}, 0.0, kSurfaceMargin}, {}).surface.mesh;
    const SurfaceEdit change = random_change(mesh, random, round % 2 == 0, round % 4 < 2 ? 0.3 : 3.0);
    change.apply(mesh);
    const SurfaceFaults all = faults_of(compacted(mesh.vertices, without_gone(mesh).triangles), nodes);
    const NearFaults near = faults_near(mesh, change, lattice);
    EXPECT_EQ(near.faults.links > 0, all.links > 0) << round;
    EXPECT_EQ(near.faults.equal_vertices, all.equal_vertices) << round;
    EXPECT_EQ(near.faults.degenerate_faces, all.degenerate_faces) << round;
    EXPECT_EQ(near.faults.intersections.pairs, all.intersections.pairs) << round;
    EXPECT_EQ(near.vertices.empty(), near.faults.none()) << round;
    // Where the surface passes through itself, nodes are more than on one side or the other.
    if (all.intersections.pairs == 0) {
      EXPECT_EQ(changed_nodes(mesh, change, lattice).size(), all.nodes) << round;
    }
    ++(all.none() ? right : wrong);
  }
  EXPECT_GT(right, 50);
  EXPECT_GT(wrong, 50);
}

// The edit that moves all vertices from `first` on, as many as a box has; `before` and `now`: their places' shifts.
SurfaceEdit shifted(const TriangleMesh& at_first, std::uint32_t first, double before, double now) {
  SurfaceEdit edit;
  for (std::uint32_t v = first; v < first + 8; ++v) {
    const Vec3& p = at_first.vertices[v];
    edit.vertices.push_back(v);
    edit.places.push_back({p + Vec3{before, 0, 0}, p + Vec3{now, 0, 0}});
  }
  for (std::uint32_t face = 0; face < at_first.triangles.size(); ++face) {
    const Triangle& t = at_first.triangles[face];
    if (t[0] < first || t[0] >= first + 8) continue;
    edit.faces.push_back(face);
    edit.corners.push_back({t, t});
  }
  return edit;
}

SurfaceEdit both(SurfaceEdit a, const SurfaceEdit& b) {
  a.faces.insert(a.faces.end(), b.faces.begin(), b.faces.end());
  a.corners.insert(a.corners.end(), b.corners.begin(), b.corners.end());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  a.places.insert(a.places.end(), b.places.begin(), b.places.end());
  return a;
}

// Of two boxes the second one comes over the node in the first one, which it goes around twice then; both leave; the
// first one comes back. When both have left, the node is on another side than at first, but in two steps at once.
TEST(SurfaceCertificate, AddsUpNodesThatAMeshWentAroundTwice) {
  const DefaultFloatingPoint guard;
  const Lattice lattice{{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {8, 8, 8}};
  const TriangleMesh at_first =
      test::joined(test::box_mesh({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}), test::box_mesh({3.7, 1.6, 1.6}, {3.9, 2.4, 2.4}));
  const std::uint32_t second = 8;
  TriangleMesh mesh = at_first;
  NodeSet nodes(lattice);
  const auto after = [&](const SurfaceEdit& change) {
    change.apply(mesh);
    nodes.flip(changed_nodes(mesh, change, lattice));
    return nodes.size();
  };
  EXPECT_EQ(after(shifted(at_first, second, 0.0, -1.8)), 1U);
  EXPECT_EQ(after(both(shifted(at_first, 0, 0.0, 3.6), shifted(at_first, second, -1.8, 0.5))), 2U);
  EXPECT_TRUE(nodes.holds(2, 2, 2));
  EXPECT_EQ(after(shifted(at_first, 0, 3.6, 0.0)), 0U);
}

// A node that has changed sides stays so.
TEST(SurfaceCertificate, CountsNodesThatHaveChangedSides) {
  const DefaultFloatingPoint guard;
  const TriangleMesh at_first = test::box_mesh({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5});
  TriangleMesh mesh = at_first;
  NodeSet nodes({{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {8, 8, 8}});
  for (const auto& [before, now, changed] :
       {std::tuple{0.0, 0.4, 0U}, {0.4, 1.2, 2U}, {1.2, 1.3, 2U}, {1.3, 0.1, 0U}}) {
    const SurfaceEdit change = shifted(at_first, 0, before, now);
    change.apply(mesh);
    nodes.flip(changed_nodes(mesh, change, nodes.lattice()));
    EXPECT_EQ(nodes.size(), changed) << now;
  }
}

// Vertices that have left their edge, face or tetrahedron by less than anything else would notice.
TEST(SurfaceCertificate, FindsVerticesOutOfPlace) {
  Random random(4);
  const DefaultFloatingPoint guard;
  const NodeSet nodes = nodes_where(lattice_off_origin(5), [](auto i, auto j, auto k) { return i + j + k < 6; });
  const SurfaceCells cells(nodes);
  const FacePoints face_points = random_face_points(cells, random);
  const auto [surface, tetrahedra, first_apex, fewer] =
      contour({cells, random_edge_points(cells, random, false), {}, 0.0, kSurfaceMargin}, face_points);
  const std::vector<Vec3>& vertices = surface.mesh.vertices;
  EXPECT_EQ(misplaced(vertices, cells, face_points, tetrahedra), 0U);
  EXPECT_EQ(first_apex, cells.edges() + face_points.positions().size());
  const Vec3 off{1e-7, 2e-7, 3e-7}, away{2.0, 0.0, 0.0};
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    std::vector<Vec3> moved = vertices;
    moved[v] = moved[v] + (v < first_apex ? off : away);
    EXPECT_EQ(misplaced(moved, cells, face_points, tetrahedra), 1U) << v;
  }
  for (std::size_t n = 0; n < tetrahedra.size(); ++n) {
    std::vector<std::uint64_t> others(tetrahedra.begin(), tetrahedra.end());
    others[n] = others[n] % 6 == 5 ? others[n] - 1 : others[n] + 1;
    EXPECT_EQ(misplaced(vertices, cells, face_points, others), 1U) << n;
  }
  // The ends of an edge are not inside of it.
  const SurfaceCell& cell = cells.cells().front();
  const auto direction = static_cast<unsigned>(std::countr_zero(cell.mixed_directions()));
  for (const unsigned corner : {0U, direction}) {
    std::vector<Vec3> at_end = vertices;
    at_end[cell.edge(direction)] = cells.corner(cell, corner);
    EXPECT_EQ(misplaced(at_end, cells, face_points, tetrahedra), 1U) << corner;
  }
}

}  // namespace
}  // namespace raycone
