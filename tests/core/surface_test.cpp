// The closed surface between nodes: closed, embedded and where the mesh is, for any labels of nodes and any points.
#include "core/surface/surface.h"
#include "core/surface/contour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/distance/distance.h"
#include "core/exact/quad.h"
#include "core/machine/floating_point.h"
#include "core/mesh/exterior_edges.h"
#include "core/mesh/mesh_statistics.h"
#include "core/mesh/used_part.h"
#include "core/mesh/weld.h"
#include "core/surface/checked_sharpen.h"
#include "core/surface/edge_crossing.h"
#include "core/surface/face_sources.h"
#include "core/surface/fault_places.h"
#include "core/surface/merge_planes.h"
#include "core/surface/mesh_as_surface.h"
#include "core/surface/mesh_corners.h"
#include "core/surface/patch_merger.h"
#include "core/surface/repeated_check.h"
#include "core/surface/sharpen.h"
#include "core/surface/surface_cells.h"
#include "core/surface/surface_measures.h"
#include "core/surface/vertex_places.h"
#include "tests/support/exact_intersections.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::Random;
using test::uniform;

constexpr SurfaceMargins kMargins;

Lattice lattice_of(std::int64_t side, double spacing = 1.0) {
  return {{-0.3, 0.2, 0.1}, {spacing, spacing, spacing}, {-1, 2, 0}, {side, side, side}};
}

NodeSet nodes_where(const Lattice& lattice,
                    const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& inside) {
  NodeSet nodes(lattice);
  for (std::int64_t k = 1; k + 1 < lattice.counts[2]; ++k) {
    for (std::int64_t j = 1; j + 1 < lattice.counts[1]; ++j) {
      for (std::int64_t i = 1; i + 1 < lattice.counts[0]; ++i) {
        if (inside(i, j, k)) nodes.insert(i, j, k);
      }
    }
  }
  return nodes;
}

// Often as near to an end as is allowed, where that is asked for.
double random_place(Random& random, bool to_margin) {
  const double extremes = to_margin ? uniform(random, 0.0, 4.0) : 4.0;
  if (extremes < 1.0) return kMargins.inner;
  if (extremes < 2.0) return 1.0 - kMargins.inner;
  return uniform(random, 0.01, 0.99);
}

std::vector<EdgePoint> random_edge_points(const SurfaceCells& cells, Random& random, bool to_margin) {
  std::vector<EdgePoint> points(cells.edges());
  for (const SurfaceCell& cell : cells.cells()) {
    for (unsigned direction = 1; direction < kuhn::kCorners; ++direction) {
      if ((cell.mixed_directions() >> direction & 1U) == 0) continue;
      const Vec3 low = cells.corner(cell, 0), high = cells.corner(cell, direction);
      points[cell.edge(direction)].position = low + random_place(random, to_margin) * (high - low);
    }
  }
  return points;
}

// On half of the mixed faces, anywhere within.
FacePoints random_face_points(const SurfaceCells& cells, Random& random) {
  std::vector<std::uint64_t> faces;
  std::vector<Vec3> positions;
  for (std::size_t n = 0; n < cells.cells().size(); ++n) {
    const SurfaceCell& cell = cells.cells()[n];
    for (std::size_t face = 0; face < kuhn::kFaces.size(); ++face) {
      const auto [first, second] = kuhn::kFaces[face];
      const bool mixed = cell.is_inside(0) != cell.is_inside(first) || cell.is_inside(0) != cell.is_inside(second);
      if (!mixed || uniform(random, 0.0, 1.0) < 0.5) continue;
      const double a = random_place(random, false), b = random_place(random, false), c = random_place(random, false);
      const double sum = a + b + c;
      const double u = a / sum, v = b / sum;
      const Vec3 low = cells.corner(cell, 0);
      faces.push_back(number_of_face(static_cast<std::uint32_t>(n), face));
      positions.push_back(low + u * (cells.corner(cell, first) - low) + v * (cells.corner(cell, second) - low));
    }
  }
  return {faces, positions};
}

// As misplaced_vertices() of all vertices of a contour without spare points.
std::uint64_t misplaced(std::span<const Vec3> vertices, const SurfaceCells& cells, const FacePoints& face_points,
                        std::span<const std::uint64_t> tetrahedra) {
  std::vector<EdgePoint> edges(cells.edges());
  for (std::size_t n = 0; n < edges.size(); ++n) edges[n].position = vertices[n];
  const std::span faces = vertices.subspan(edges.size(), face_points.faces().size());
  const std::span apexes = vertices.subspan(edges.size() + faces.size());
  return misplaced_vertices({edges, faces, apexes}, cells, face_points, tetrahedra, kMargins);
}

// Face points next to the margin of others would need a wider one: rounding then spoils what is thin twice over. Such
// points are dropped by closed_surface().
SurfaceFaults faults_of_random_surface(const NodeSet& nodes, Random& random, bool with_face_points) {
  const DefaultFloatingPoint guard;
  const SurfaceCells cells(nodes);
  const std::vector<EdgePoint> points = random_edge_points(cells, random, !with_face_points);
  const FacePoints face_points = with_face_points ? random_face_points(cells, random) : FacePoints();
  const auto [surface, tetrahedra, first_apex, fewer] = contour({cells, points, {}, 0.0, kMargins}, face_points);
  SurfaceFaults faults = faults_of(surface.mesh, nodes);
  faults.places = misplaced(surface.mesh.vertices, cells, face_points, tetrahedra);
  return faults;
}

// Of the eight nodes of a cell, all others are outside.
NodeSet nodes_of_label(unsigned label) {
  return nodes_where(lattice_of(4), [&](auto i, auto j, auto k) {
    return (label >> static_cast<unsigned>((i - 1) + 2 * (j - 1) + 4 * (k - 1)) & 1U) != 0;
  });
}

TEST(Surface, IsRightForEachLabellingOfACell) {
  Random random(1);
  for (unsigned label = 1; label < 256; ++label) {
    for (const bool with_face_points : {false, true}) {
      const SurfaceFaults faults = faults_of_random_surface(nodes_of_label(label), random, with_face_points);
      ASSERT_TRUE(faults.none()) << label << ": " << described(faults);
    }
  }
}

// By the definition, for all pairs of triangles in rational numbers, which takes its time.
TEST(Surface, IsFreeOfIntersectionsByTheDefinition) {
  const DefaultFloatingPoint guard;
  Random random(3);
  for (unsigned label = 1; label < 256; label += 17) {
    const NodeSet nodes = nodes_of_label(label);
    const SurfaceCells cells(nodes);
    for (const bool with_face_points : {false, true}) {
      const std::vector<EdgePoint> points = random_edge_points(cells, random, !with_face_points);
      const FacePoints face_points = with_face_points ? random_face_points(cells, random) : FacePoints();
      TriangleMesh mesh = contour({cells, points, {}, 0.0, kMargins}, face_points).surface.mesh;
      ASSERT_TRUE(test::exact_self_intersections(mesh).empty()) << label;
      if (label > 1) continue;
      const Vec3 across = mesh.vertices[mesh.triangles.back()[0]];
      mesh.vertices[0] = mesh.vertices[0] + 3.0 * (across - mesh.vertices[0]);  // through other faces
      EXPECT_FALSE(test::exact_self_intersections(mesh).empty());
    }
  }
}

// For a longer check, RAYCONE_LABEL_ROUNDS=100000.
int label_rounds() {
  const char* const text = std::getenv("RAYCONE_LABEL_ROUNDS");
  return text ? std::stoi(text) : 60;
}

TEST(Surface, IsRightForRandomLabels) {
  Random random(2);
  for (int round = 0; round < label_rounds(); ++round) {
    const double density = uniform(random, 0.05, 0.95);
    const NodeSet nodes = nodes_where(lattice_of(3 + round % 5, round % 2 == 0 ? 1.0 : 0.013),
                                      [&](auto, auto, auto) { return uniform(random, 0.0, 1.0) < density; });
    if (nodes.empty()) continue;
    const SurfaceFaults faults = faults_of_random_surface(nodes, random, round % 3 != 0);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
  }
}

TriangleMesh without_gone(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, is_gone);
  return mesh;
}

// Those that a surface has had before spare ones were added.
TriangleMesh first_of(const TriangleMesh& mesh, const TriangleMesh& before) {
  TriangleMesh first = without_gone(mesh);
  first.vertices.resize(before.vertices.size());
  return first;
}

// With the vertices that faces have.
TriangleMesh compacted(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (Triangle t : triangles) {
    for (std::uint32_t& corner : t) {
      const auto [at, is_new] = numbers.try_emplace(corner, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(vertices[corner]);
      corner = at->second;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

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
  const NodeSet nodes = nodes_where(lattice_of(5), [](auto i, auto j, auto k) { return i + j + k < 6; });
  const SurfaceCells cells(nodes);
  const SurfaceMesh surface = contour({cells, random_edge_points(cells, random, true), {}, 0.0, kMargins}, {}).surface;
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
  const Lattice lattice = lattice_of(8);
  int right = 0, wrong = 0;
  for (int round = 0; round < 400; ++round) {
    const NodeSet nodes = nodes_where(lattice, [&](auto i, auto j, auto k) { return i + j + k < 9 + round % 4; });
    const SurfaceCells cells(nodes);
    TriangleMesh mesh = contour({cells, random_edge_points(cells, random, false), {}, 0.0, kMargins}, {}).surface.mesh;
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
  const NodeSet nodes = nodes_where(lattice_of(5), [](auto i, auto j, auto k) { return i + j + k < 6; });
  const SurfaceCells cells(nodes);
  const FacePoints face_points = random_face_points(cells, random);
  const auto [surface, tetrahedra, first_apex, fewer] =
      contour({cells, random_edge_points(cells, random, false), {}, 0.0, kMargins}, face_points);
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

TEST(SegmentHit, IsExactAboutEnds) {
  const DefaultFloatingPoint guard;
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, a, b, c), 0.5);
  EXPECT_EQ(segment_hit({0.25, 0.25, 0}, {0.25, 0.25, 1}, a, b, c), 0.0);
  EXPECT_EQ(segment_hit({0.25, 0.25, 1}, {0.25, 0.25, 0}, a, b, c), 1.0);
  EXPECT_EQ(segment_hit({1, 0, -1}, {1, 0, 1}, a, b, c), 0.5);                                  // through a corner
  EXPECT_EQ(segment_hit({std::nextafter(1.0, 2.0), 0, -1}, {1, 0, 1}, a, b, c), std::nullopt);  // and beside it
  EXPECT_EQ(segment_hit({-1, 0.25, 0}, {1, 0.25, 0}, a, b, c), std::nullopt);                   // in its plane
  EXPECT_EQ(segment_hit({0.25, 0.25, 0x1p-1074}, {0.25, 0.25, 1}, a, b, c), std::nullopt);
  EXPECT_EQ(segment_hit({0.25, 0.25, -1}, {0.25, 0.25, 1}, a, b, {2, 0, 0}), std::nullopt);  // without area
}

// Whole numbers, so that many ends and edges are in planes of triangles, on their sides or at their corners.
TEST(HitFinder, FindsWhatSegmentsHitOneByOne) {
  const DefaultFloatingPoint guard;
  Random random(21);
  const auto point = [&](double size, double step) {
    const auto number = [&] { return step * std::round(uniform(random, -size, size)); };
    return Vec3{number(), number(), number()};
  };
  std::size_t at_ends = 0, between = 0;
  for (const double step : {1.0, 0.1, 0x1p-40}) {
    for (int round = 0; round < 300; ++round) {
      const TriangleMesh mesh{{point(3, step), point(3, step), point(3, step), point(3, step)},
                              {{0, 1, 2}, {1, 2, 3}, {0, 3, 1}}};
      HitFinder finder(mesh);
      for (int ends = 0; ends < 3; ++ends) {
        const Vec3 end = point(2, step);
        finder.enter(end, std::array<std::uint32_t, 3>{0, 1, 2});
        for (int others = 0; others < 7; ++others) {
          const Vec3 other = point(2, step);
          const bool from_end = others % 2 == 0;
          const Vec3 &p = from_end ? end : other, &q = from_end ? other : end;
          std::vector<SegmentHit> hits;
          finder.find(other, from_end, hits);
          for (std::uint32_t triangle = 0; triangle < 3; ++triangle) {
            const Triangle& t = mesh.triangles[triangle];
            const auto hit = std::ranges::find(hits, triangle, &SegmentHit::triangle);
            const std::optional<double> found = hit == hits.end() ? std::nullopt : std::optional(hit->at);
            const std::optional<double> here =
                segment_hit(p, q, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
            ASSERT_EQ(found, here) << step << " " << round << " " << ends << " " << others << " " << triangle;
            at_ends += here == 0.0 || here == 1.0 ? 1 : 0;
            between += here && *here > 0.0 && *here < 1.0 ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(at_ends, 1000U);
  EXPECT_GT(between, 1000U);
}

// By angles that are no special ones.
TriangleMesh rotated(TriangleMesh mesh) {
  const Vec3 u{0.36, 0.48, -0.8}, v{-0.8, 0.6, 0.0}, w{0.48, 0.64, 0.6};
  for (Vec3& p : mesh.vertices) p = {dot(u, p), dot(v, p), dot(w, p)};
  return mesh;
}

// A wedge with an angle of some degrees.
TriangleMesh wedge() {
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {3, 1, 1});
  for (Vec3& p : mesh.vertices) {
    if (p.x > 1.0) p.z = p.z * 0.25;
  }
  return mesh;
}

struct Made {
  SurfaceMesh surface;
  Lattice lattice;
};

Made surface_of(const TriangleMesh& mesh, std::int64_t side, const SurfaceOptions& options = {}) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower;
  const double h = std::max({size.x, size.y, size.z}) / static_cast<double>(side - 3);
  const Lattice lattice{box.lower, {h, h, h}, {-1, -1, -1}, {side + 1, side + 1, side + 1}};
  const WindingNumberEvaluator evaluator(mesh);
  const NodeSet nodes = nodes_inside(evaluator, options.rule, lattice);
  Made made{closed_surface(mesh, evaluator, nodes, options).surface, lattice};
  EXPECT_TRUE(faults_of(made.surface.mesh, nodes).none());
  return made;
}

// Far from 1, squares of areas over- or underflow.
TEST(Surface, IsTheSameInEveryUnitOfLength) {
  TriangleMesh ball = test::sphere(8);
  for (Vec3& v : ball.vertices) v = (1.0 + 0.1 * std::sin(5 * v.x + 3 * v.y)) * v;
  TriangleMesh cup = ball;
  std::erase_if(cup.triangles, [&](const Triangle& t) { return cup.vertices[t[0]].z > 0.6; });
  for (const TriangleMesh& mesh : {weld(ball, {}), weld(cup, {})}) {
    const std::size_t unsimplified = surface_of(mesh, 20).surface.mesh.triangles.size();
    for (const double simplify : {0.0, 0.02}) {
      SurfaceOptions options;
      options.simplify = simplify;
      const TriangleMesh expected = surface_of(mesh, 20, options).surface.mesh;
      if (simplify > 0.0) {
        EXPECT_LT(expected.triangles.size(), unsimplified);  // else nothing has been tested
      }
      for (const int exponent : {-850, -300, -100, -60, 60, 100, 300, 900}) {
        const double unit = std::ldexp(1.0, exponent);
        options.simplify = simplify * unit;
        const TriangleMesh made = surface_of(test::moved(mesh, {unit, unit, unit}, {}), 20, options).surface.mesh;
        EXPECT_EQ(made.triangles, expected.triangles) << exponent;
        EXPECT_EQ(made.vertices, test::moved(expected, {unit, unit, unit}, {}).vertices) << exponent;
      }
    }
  }
}

double largest_distance_of(const std::vector<Vec3>& points, const TriangleMesh& mesh) {
  std::vector<double> distances(points.size());
  DistanceEvaluator(mesh).evaluate(points, distances);
  return *std::ranges::max_element(distances);
}

// How many of the points are within 1e-9 voxels of the mesh, which is about the margin.
double part_at(const std::vector<Vec3>& points, const TriangleMesh& mesh, double voxel) {
  std::vector<double> distances(points.size());
  DistanceEvaluator(mesh).evaluate(points, distances);
  const auto near = std::ranges::count_if(distances, [&](double d) { return d <= 2e-9 * voxel; });
  return static_cast<double>(near) / static_cast<double>(points.size());
}

std::vector<Vec3> points_of_edges(const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      for (int n = 1; n < 100; ++n) points.push_back(a + (n / 100.0) * (b - a));
    }
  }
  return points;
}

// Whether the tetrahedron that holds a point has nodes of both kinds: there the lattice resolves a sharp edge.
bool is_resolved(const Vec3& p, const NodeSet& nodes) {
  const Lattice& lattice = nodes.lattice();
  std::array<std::int64_t, 3> node{};
  std::array<std::pair<double, std::size_t>, 3> order;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    const double at =
        (p[axis] - lattice.origin[axis]) / lattice.spacing[axis] - static_cast<double>(lattice.index_min[n]);
    node[n] = static_cast<std::int64_t>(std::floor(at));
    order[n] = {std::floor(at) - at, n};
  }
  std::ranges::sort(order);
  int inside = nodes.holds(node[0], node[1], node[2]) ? 1 : 0;
  for (const auto& [fraction, axis] : order) {
    ++node[axis];
    inside += nodes.holds(node[0], node[1], node[2]) ? 1 : 0;
  }
  return inside > 0 && inside < 4;
}

// A prism over a polygon that is nearly round.
TriangleMesh cylinder() {
  constexpr std::uint32_t kSides = 24;
  TriangleMesh mesh;
  for (std::uint32_t side = 0; side < kSides; ++side) {
    const double angle = 2.0 * std::numbers::pi * side / kSides;
    for (const double z : {0.0, 1.3}) mesh.vertices.push_back({std::cos(angle), std::sin(angle), z});
  }
  for (std::uint32_t side = 0; side < kSides; ++side) {
    const std::uint32_t a = 2 * side, b = 2 * ((side + 1) % kSides);
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
    if (side > 0 && side + 1 < kSides) mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {1, a + 1, b + 1}});
  }
  return mesh;
}

// All of it, at any angle, between outside nodes, too, where the lattice does not see an edge: a quarter of its length
// or so. Of the cylinder's 72 edges some may be left where three meet that no single point of a gap is on.
TEST(Surface, KeepsSharpEdges) {
  for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge(), cylinder()}) {
    const bool is_round = shape.triangles.size() > 12;
    const TriangleMesh mesh = rotated(shape);
    const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
    const double h = lattice.spacing.x;
    const NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
    std::vector<Vec3> all = points_of_edges(mesh), resolved;
    std::ranges::copy_if(all, std::back_inserter(resolved), [&](const Vec3& p) { return is_resolved(p, nodes); });
    EXPECT_LT(resolved.size(), 0.95 * static_cast<double>(all.size()));
    EXPECT_GE(part_at(resolved, surface.mesh, h), is_round ? 0.98 : 0.999);
    EXPECT_GE(part_at(all, surface.mesh, h), is_round ? 0.98 : 0.999);
    EXPECT_LT(largest_distance_of(all, surface.mesh), is_round ? 0.2 * h : 4e-9 * h);
    // The margin moves a vertex by less than two margins along each axis.
    EXPECT_LT(largest_distance_of(surface.mesh.vertices, mesh), 4e-9 * h);
    const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
    EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 0.01 * volume);
  }
}

// A lattice whose nodes are not in the planes of a box sees some of its edges pass between outside nodes, from end to
// end.
TEST(Surface, KeepsEdgesThatPassBetweenOutsideNodes) {
  const TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<Vec3> edges = points_of_edges(mesh);
  for (const Vec3& shift : {Vec3{0.03, 0.11, 0.07}, Vec3{0.12, 0.02, 0.05}}) {
    const double h = 1.0 / 20;
    const Lattice lattice{-1.0 * shift, {h, h, h}, {-1, -1, -1}, {30, 30, 30}};
    const WindingNumberEvaluator evaluator(mesh);
    const NodeSet nodes = nodes_inside(evaluator, Rule{}, lattice);
    const auto resolved = std::ranges::count_if(edges, [&](const Vec3& p) { return is_resolved(p, nodes); });
    EXPECT_LT(resolved, 0.9 * static_cast<double>(edges.size()));  // what tetrahedra alone can keep
    for (const bool merged : {true, false}) {
      const SurfaceMesh surface = closed_surface(mesh, evaluator, nodes, {.rule = {}, .merge_planes = merged}).surface;
      EXPECT_TRUE(faults_of(surface.mesh, nodes).none());
      EXPECT_EQ(part_at(edges, surface.mesh, h), 1.0);
      if (merged) {
        EXPECT_EQ(surface.mesh.triangles.size(), 12U);
      }
    }
  }
}

// At arbitrary angles, a quarter of each edge passes so.
TEST(Surface, KeepsEdgesOfTurnedParts) {
  for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge()}) {
    const TriangleMesh mesh = rotated(shape);
    const auto [surface, lattice] = surface_of(mesh, 24);
    EXPECT_EQ(surface.mesh.triangles.size(), 12U);
    EXPECT_EQ(part_at(points_of_edges(mesh), surface.mesh, lattice.spacing.x), 1.0);
    EXPECT_LE(largest_distance_of(surface.mesh.vertices, mesh), 1e-8 * lattice.spacing.x);
    const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
    EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 1e-8 * volume);
  }
}

// By an angle about an axis.
TriangleMesh turned(TriangleMesh mesh, const Vec3& axis, double angle) {
  const Vec3 u = (1 / norm(axis)) * axis;
  for (Vec3& p : mesh.vertices) {
    const Vec3 along = dot(u, p) * u;
    p = along + std::cos(angle) * (p - along) + std::sin(angle) * cross(u, p);
  }
  return mesh;
}

// Of three cubes and of four around a corner, and of a cross, where three planes meet in six faces. Gaps there cannot
// be filled by what is around them alone: faces of the contour reach beyond the corner.
TEST(Surface, KeepsConcaveCorners) {
  using Cells = std::vector<std::array<int, 3>>;
  const Cells step{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, pit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      cross_of_cells{{1, 1, 1}, {0, 1, 1}, {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}};
  const Cells chain{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  for (const Cells& cells : {step, pit, cross_of_cells, chain}) {
    for (int n = 0; n < 24; ++n) {
      const TriangleMesh mesh =
          turned(test::cells_mesh(cells), {1.0, 0.3 * (n % 8) - 1.0, 0.7 - 0.1 * n}, 0.4 + 0.9 * n);
      const auto [surface, lattice] = surface_of(mesh, 18 + n);
      // Points are kept off nodes by 4 2^-30 voxels at most.
      EXPECT_LE(largest_distance_of(points_of_edges(mesh), surface.mesh), 4e-9 * lattice.spacing.x) << n;
      EXPECT_LE(largest_distance_of(surface.mesh.vertices, mesh), 4e-9 * lattice.spacing.x) << n;
      // Faces may still lie across a notch, with all of their edges on the mesh.
      const double volume = mesh_statistics(mesh).signed_volume.value_or(0.0);
      EXPECT_NEAR(mesh_statistics(surface.mesh).signed_volume.value_or(0.0), volume, 1e-8 * volume) << n;
    }
  }
}

// Two pyramids that touch with their tips.
TriangleMesh hourglass() {
  return {{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}, {1, 0, -1}, {0, 1, -1}, {-1, 0, -1}, {0, -1, -1}},
          {{0, 2, 1},
           {0, 3, 2},
           {0, 4, 3},
           {0, 1, 4},
           {1, 2, 3},
           {1, 3, 4},
           {0, 5, 6},
           {0, 6, 7},
           {0, 7, 8},
           {0, 8, 5},
           {5, 7, 6},
           {5, 8, 7}}};
}

// Of the eight planes at the tip, those of two faces that meet in an edge leave a whole line to choose from.
TEST(Surface, KeepsTipsThatTouch) {
  for (int n = 0; n < 24; ++n) {
    const TriangleMesh mesh = turned(hourglass(), {1.0, 0.3 * (n % 8) - 1.0, 0.7 - 0.1 * n}, 0.4 + 0.9 * n);
    const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& p : surface.mesh.vertices) nearest = std::min(nearest, norm(p - mesh.vertices[0]));
    // The margin moves a vertex by less than two margins along each axis.
    EXPECT_LT(nearest, 4e-9 * lattice.spacing.x) << n;
  }
}

// As floats are, or six or seven digits of text: triangles of one plane are no more in one plane then.
TEST(Surface, KeepsEdgesAndFacesOfPartsWithRoundedCoordinates) {
  const auto as_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  const auto as_text = [](const char* format) {
    return [format](double x) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), format, x);
      return std::strtod(text.data(), nullptr);
    };
  };
  const std::vector<std::function<double(double)>> roundings{as_float, as_text("%.6e"), as_text("%.6f"), as_text("%g")};
  int few = 0;
  for (const auto& rounded : roundings) {
    for (const TriangleMesh& shape : {test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}), wedge()}) {
      TriangleMesh mesh = rotated(shape);
      for (Vec3& v : mesh.vertices) v = {rounded(v.x), rounded(v.y), rounded(v.z)};
      for (const int side : {17, 24, 33}) {
        const auto [surface, lattice] = surface_of(mesh, side);
        EXPECT_LT(largest_distance_of(points_of_edges(mesh), surface.mesh), 1e-4 * lattice.spacing.x) << side;
        EXPECT_LT(largest_distance_of(surface.mesh.vertices, mesh), 1e-4 * lattice.spacing.x) << side;
        few += surface.mesh.triangles.size() <= 24 ? 1 : 0;
      }
    }
  }
  // Faces stay around nodes that merging would put on the other side of a plane, and "%g" rounds more.
  EXPECT_GE(few, 16);
}

// A prism over the unit square of x and z whose corner (1, 1) is cut off by a tenth. Its first two faces are the cut.
TriangleMesh cut_box() {
  const std::array<std::pair<double, double>, 5> outline{{{1, 0.9}, {0.9, 1}, {0, 1}, {0, 0}, {1, 0}}};
  TriangleMesh mesh;
  for (const auto& [x, z] : outline) {
    mesh.vertices.push_back({x, 0, z});
    mesh.vertices.push_back({x, 1, z});
  }
  for (std::uint32_t side = 0; side < 5; ++side) {
    const std::uint32_t a = 2 * side, b = 2 * ((side + 1) % 5);
    mesh.triangles.insert(mesh.triangles.end(), {{a, b + 1, b}, {a, a + 1, b + 1}});
  }
  for (std::uint32_t side = 1; side < 4; ++side) {
    mesh.triangles.insert(mesh.triangles.end(), {{0, 2 * side, 2 * side + 2}, {1, 2 * side + 3, 2 * side + 1}});
  }
  return mesh;
}

// Faces that lead across an edge are taken back to where the planes meet; not where the mesh has no such edge.
TEST(Sharpening, PullsNothingOffTheMesh) {
  const DefaultFloatingPoint guard;
  // Most faces must be in their planes, which those of a second box are.
  const TriangleMesh other = test::box_mesh({2, 0, 0}, {3, 1, 1});
  const TriangleMesh cut = test::joined(cut_box(), other);
  const TriangleMesh whole_box = test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), other);
  ASSERT_NEAR(mesh_statistics(cut).signed_volume.value_or(0.0), 1.995, 1e-12);
  const auto on_the_top = [](const TriangleMesh& mesh) {
    for (std::int32_t face = 0;; ++face) {
      const Triangle& t = mesh.triangles[static_cast<std::size_t>(face)];
      if (std::ranges::all_of(t, [&](std::uint32_t v) { return mesh.vertices[v].z == 1.0; })) return face;
    }
  };
  SurfaceMesh surface{cut, std::vector<std::int32_t>(cut.triangles.size())};
  std::iota(surface.sources.begin(), surface.sources.end(), 0);
  surface.sources[0] = surface.sources[1] = on_the_top(cut);
  const SharpenLimits limits{1e-9, 0.2, false};
  const DistanceEvaluator from_cut(cut), from_whole(whole_box);
  Sharpener of_cut(surface, cut, TriangleNormals(cut), from_cut, limits);
  static_cast<void>(of_cut.sharpen());
  EXPECT_EQ(of_cut.pulls(), 0U);
  for (std::int32_t& source : surface.sources) source %= 24;  // triangles of the whole boxes
  SourceSettler(whole_box, TriangleNormals(whole_box), from_whole, 0.01).settle(surface);
  Sharpener of_whole(surface, whole_box, TriangleNormals(whole_box), from_whole, limits);
  of_whole.sharpen();
  EXPECT_EQ(of_whole.pulls(), 1U);  // the gap between four planes
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 2.0, 1e-12);
  // One end of the cut stays: so does what would be pulled into it. The other one is pulled.
  of_whole.keep({0}, false);
  EXPECT_EQ(of_whole.pulls(), 1U);
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 2.0 - 0.005 / 3, 1e-12);
  of_whole.keep({0}, true);
  EXPECT_EQ(of_whole.pulls(), 0U);
  EXPECT_EQ(first_of(surface.mesh, cut).triangles, cut.triangles);
  EXPECT_EQ(first_of(surface.mesh, cut).vertices, cut.vertices);
}

// Strips that do not hang together have nothing to do with each other.
TEST(Sharpening, PullsTheStripsAnewThatHaveWhatIsKept) {
  const DefaultFloatingPoint guard;
  TriangleMesh second = cut_box(), second_box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  for (TriangleMesh* mesh : {&second, &second_box}) {
    for (Vec3& p : mesh->vertices) p = p + Vec3{0, 3, 0};
  }
  const TriangleMesh others = test::joined(test::box_mesh({2, 0, 0}, {3, 1, 1}), test::box_mesh({4, 0, 0}, {5, 1, 1}));
  const TriangleMesh cut = test::joined(test::joined(cut_box(), second), others);
  const TriangleMesh whole = test::joined(test::joined(test::box_mesh({0, 0, 0}, {1, 1, 1}), second_box), others);
  SurfaceMesh surface{cut, std::vector<std::int32_t>(cut.triangles.size(), 0)};
  const DistanceEvaluator distance(whole);
  SourceSettler(whole, TriangleNormals(whole), distance, 0.01).settle(surface);
  Sharpener sharpener(surface, whole, TriangleNormals(whole), distance, {1e-9, 0.2, false});
  sharpener.sharpen();
  ASSERT_EQ(sharpener.pulls(), 2U);
  const SurfaceEdit change = sharpener.keep({0, 1, 2, 3}, false);
  EXPECT_EQ(sharpener.pulls(), 1U);
  EXPECT_EQ(change.vertices.size(), 2U);
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 4.0 - 0.005, 1e-12);
  // Faults that are left where nothing changes any more would else not be found.
  const SurfaceEdit no_change = sharpener.keep({0, 1, 2, 3}, false);
  EXPECT_FALSE(change.changes_nothing());
  EXPECT_TRUE(no_change.changes_nothing());
  EXPECT_TRUE(std::ranges::find(no_change.faces, 0U) != no_change.faces.end());
  sharpener.undo();
  EXPECT_EQ(surface.mesh.triangles, cut.triangles);
  EXPECT_EQ(surface.mesh.vertices, cut.vertices);
}

// Two boxes with cuts, and what they are cut off. Something stands where the first cut would be taken back to; from
// 0.95 downwards it stands in the cut as well.
struct OccupiedCut {
  SurfaceMesh surface;
  TriangleMesh input;
};

OccupiedCut occupied_cut(double lower) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1}), other = test::moved(box, {1, 1, 1}, {2, 0, 0});
  const TriangleMesh others = test::joined(test::box_mesh({lower, 0.4, lower}, {1.05, 0.6, 1.05}), other);
  const auto with_others = [&](const TriangleMesh& mesh) {
    return test::joined(test::joined(mesh, test::moved(mesh, {1, 1, 1}, {0, 3, 0})), others);
  };
  const TriangleMesh cut = with_others(cut_box());
  OccupiedCut made{{cut, std::vector<std::int32_t>(cut.triangles.size(), 0)}, with_others(box)};
  SourceSettler(made.input, TriangleNormals(made.input), DistanceEvaluator(made.input), 0.01).settle(made.surface);
  return made;
}

bool is_sharpened(OccupiedCut& cut, int rounds) {
  const Lattice lattice{{-1.08, -1.08, -1.08}, {0.1, 0.1, 0.1}, {0, 0, 0}, {60, 70, 30}};  // no node in a cut
  return checked_sharpen(cut.surface, cut.input, TriangleNormals(cut.input), DistanceEvaluator(cut.input), lattice,
                         {1e-9, 0.2, false}, rounds);
}

// What the last round had put back was left as it had been pulled, with corners that are no more.
TEST(Sharpening, LeavesTheSurfaceAsItWasWhereFaultsAreLeft) {
  const DefaultFloatingPoint guard;
  for (const int rounds : {0, 1}) {
    OccupiedCut cut = occupied_cut(0.96);
    const SurfaceMesh before = cut.surface;
    EXPECT_FALSE(is_sharpened(cut, rounds));
    EXPECT_EQ(cut.surface.mesh.triangles, before.mesh.triangles) << rounds;
    EXPECT_EQ(cut.surface.mesh.vertices, before.mesh.vertices) << rounds;
    EXPECT_EQ(cut.surface.sources, before.sources) << rounds;
  }
  OccupiedCut cut = occupied_cut(0.96);
  const double before = mesh_statistics(cut.surface.mesh).signed_volume.value_or(0.0);
  EXPECT_TRUE(is_sharpened(cut, 2));
  EXPECT_NEAR(mesh_statistics(cut.surface.mesh).signed_volume.value_or(0.0), before + 0.005, 1e-12);  // the free one
}

// Else nobody would wait for so many rounds.
TEST(Sharpening, EndsWhereFaultsDoNotComeFromPulls) {
  const DefaultFloatingPoint guard;
  OccupiedCut cut = occupied_cut(0.93);
  const SurfaceMesh before = cut.surface;
  EXPECT_FALSE(is_sharpened(cut, std::numeric_limits<int>::max()));
  EXPECT_EQ(cut.surface.mesh.triangles, before.mesh.triangles);
}

// The surface over the opening of a box meets the walls at the rim.
TEST(Surface, MeetsTheRimOfAHole) {
  const TriangleMesh mesh = rotated(test::open_box());
  const auto [surface, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
  std::vector<Vec3> rim;
  for (const ExteriorEdge& edge : exterior_edges(mesh)) {
    const Vec3 &a = mesh.vertices[edge.from], &b = mesh.vertices[edge.to];
    for (int n = 1; n < 200; ++n) rim.push_back(a + (n / 200.0) * (b - a));
  }
  EXPECT_GT(part_at(rim, surface.mesh, lattice.spacing.x), 0.6);
}

// The area of the faces that have one of the triangles of a plane as their source, by planes, which all of them are in.
std::map<std::pair<int, double>, double> areas_by_plane(const SurfaceMesh& surface, const TriangleMesh& input) {
  std::map<std::pair<int, double>, double> areas;
  for (std::size_t face = 0; face < surface.sources.size(); ++face) {
    const Triangle& source = input.triangles[static_cast<std::size_t>(surface.sources[face])];
    const Vec3 &a = input.vertices[source[0]], &b = input.vertices[source[1]], &c = input.vertices[source[2]];
    const Triangle& t = surface.mesh.triangles[face];
    const Vec3 &p = surface.mesh.vertices[t[0]], &q = surface.mesh.vertices[t[1]], &r = surface.mesh.vertices[t[2]];
    const Vec3 normal = cross(q - p, r - p);
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] == b[axis] && b[axis] == c[axis]) areas[{axis, a[axis]}] += std::sqrt(dot(normal, normal)) / 2;
    }
  }
  return areas;
}

// The lattice has nodes in the planes of the boxes, so that many lattice edges meet the mesh on its edges, where a
// point is on several triangles. The boxes overlap, too, and have parallel sides a voxel apart.
TEST(Surface, HasTheSourcesWhosePlanesItsFacesAreIn) {
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const std::map<std::pair<int, double>, double> ones{{{0, 0.0}, 1.0}, {{0, 1.0}, 1.0}, {{1, 0.0}, 1.0},
                                                      {{1, 1.0}, 1.0}, {{2, 0.0}, 1.0}, {{2, 1.0}, 1.0}};
  for (const std::int64_t side : {11, 13, 24}) {
    for (const bool merged : {true, false}) {
      const auto [surface, lattice] = surface_of(mesh, side, {.rule = {}, .merge_planes = merged});
      const auto areas = areas_by_plane(surface, mesh);
      ASSERT_EQ(areas.size(), ones.size());
      for (const auto& [plane, area] : areas) EXPECT_NEAR(area, ones.at(plane), 1e-6);
    }
  }
}

// The corners of a cube cut off, halfway along its edges.
TriangleMesh cuboctahedron() {
  TriangleMesh mesh;
  const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const bool is_outward = dot(cross(q - p, r - p), p) > 0.0;
    mesh.vertices.insert(mesh.vertices.end(), {p, is_outward ? q : r, is_outward ? r : q});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) add({x, y, 0}, {x, 0, z}, {0, y, z});
      add({x, 1, 0}, {x, -1, 0}, {x, 0, y});
      add({1, x, 0}, {-1, x, 0}, {0, x, y});
      add({1, 0, x}, {-1, 0, x}, {0, y, x});
    }
  }
  return weld(std::move(mesh), {});
}

// Its corners are nodes. Sharpening moves faces into the planes of others.
TEST(Surface, HasTheSourcesOfPlanesThatFacesAreMovedTo) {
  const TriangleMesh mesh = cuboctahedron();
  for (const bool merged : {true, false}) {
    const auto [surface, lattice] = surface_of(mesh, 5, {.rule = {}, .merge_planes = merged});
    for (std::size_t face = 0; face < surface.sources.size(); ++face) {
      const Triangle& t = mesh.triangles[static_cast<std::size_t>(surface.sources[face])];
      const Vec3 normal = unit_normal(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
      for (const std::uint32_t corner : surface.mesh.triangles[face]) {
        EXPECT_LT(std::abs(dot(normal, surface.mesh.vertices[corner] - mesh.vertices[t[0]])), 1e-6);  // of a voxel
      }
    }
  }
}

// What is wrong is mended; what may be right, and holes, are left alone.
TEST(FaceSources, AreSettledWhereTheyCannotBe) {
  const DefaultFloatingPoint guard;
  const TriangleMesh input = test::box_mesh({0, 0, 0}, {1, 1, 1});
  SurfaceMesh surface{input, {}};
  std::vector<std::int32_t> own(input.triangles.size());
  std::iota(own.begin(), own.end(), 0);
  surface.sources.assign(own.size(), 5);
  surface.sources[7] = kHole;
  own[7] = kHole;
  const SurfaceMesh before = surface;
  SourceSettler(input, TriangleNormals(input), DistanceEvaluator(input), 10.0).settle(surface);
  EXPECT_NE(surface.sources, before.sources);
  EXPECT_NE(surface.sources, own);  // parallel planes are within 10 of each other
  SourceSettler(input, TriangleNormals(input), DistanceEvaluator(input), 0.1).settle(surface);
  for (std::size_t face = 0; face < own.size(); ++face) {
    if (own[face] == kHole) {
      EXPECT_EQ(surface.sources[face], kHole);
      continue;
    }
    const Triangle& t = input.triangles[static_cast<std::size_t>(surface.sources[face])];
    const Triangle& expected = input.triangles[face];
    const auto normal = [&](const Triangle& u) {
      return unit_normal(input.vertices[u[0]], input.vertices[u[1]], input.vertices[u[2]]);
    };
    EXPECT_EQ(dot(normal(t), normal(expected)), 1.0);
  }
}

// The top of a box that has none: one of its faces closes the hole, and so does the one beside it.
TEST(FaceSources, AreNoneBesideAndInLineWithAHole) {
  const DefaultFloatingPoint guard;
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh input{box.vertices, {}};
  SurfaceMesh surface{box, {}};
  std::vector<std::size_t> top;
  for (std::size_t face = 0; face < box.triangles.size(); ++face) {
    const Triangle& t = box.triangles[face];
    if (std::ranges::all_of(t, [&](std::uint32_t v) { return box.vertices[v].z == 1.0; })) {
      top.push_back(face);
      surface.sources.push_back(0);
    } else {
      surface.sources.push_back(static_cast<std::int32_t>(input.triangles.size()));
      input.triangles.push_back(t);
    }
  }
  ASSERT_EQ(top.size(), 2U);
  const TriangleNormals normals(input);
  const DistanceEvaluator distance(input);
  const SourceSettler settler(input, normals, distance, 0.1);
  SurfaceMesh expected = surface, without_hole = surface;
  surface.sources[top[0]] = expected.sources[top[0]] = expected.sources[top[1]] = kHole;
  settler.settle(surface);
  EXPECT_EQ(surface.sources, expected.sources);
  settler.settle(without_hole);
  EXPECT_EQ(std::ranges::count(without_hole.sources, kHole), 0);
}

TEST(Surface, KeepsItsShapeWhereFacesAreMerged) {
  const TriangleMesh mesh = rotated(wedge());
  const auto [fine, lattice] = surface_of(mesh, 16, {.rule = {}, .merge_planes = false});
  const auto [merged, same_lattice] = surface_of(mesh, 16);
  EXPECT_LT(4 * merged.mesh.triangles.size(), fine.mesh.triangles.size());
  EXPECT_LE(largest_distance_of(fine.mesh.vertices, merged.mesh), 4e-9 * lattice.spacing.x);
}

TEST(Surface, OfAnAlignedBoxHasFewFaces) {
  const auto [surface, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 24);
  EXPECT_EQ(surface.mesh.triangles.size(), 12U);
}

// A patch with a face on each side of a sheet without thickness: a fin. All its faces are in one plane but for their
// fronts, and it has no other planes to hold its rim.
SurfacePatch fin() {
  // A square with a tip: the front, then the back, with a vertex in the middle of each side's border.
  SurfacePatch patch;
  patch.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}};
  for (std::uint32_t v = 1; v + 1 < 6; ++v) {
    patch.triangles.push_back({0, v, v + 1});
    patch.triangles.push_back({0, v + 1, v});
  }
  patch.roles.assign(patch.vertices.size(), VertexRole::kFree);
  patch.settled.assign(patch.vertices.size(), 0);
  patch.sources.assign(patch.triangles.size(), 0);
  return patch;
}

// Found by an attack: the tip of a fin was pulled in, which leaves each face in its plane.
TEST(PatchMerger, KeepsTheRimOfAFin) {
  const DefaultFloatingPoint guard;
  const TriangleMesh input{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const SurfacePatch patch = fin();
  PatchMerger merged(patch, input, {1e-9, 1e-8});
  merged.merge();
  for (const std::uint32_t corner : {0U, 2U, 3U, 4U, 5U}) EXPECT_EQ(merged.into()[corner], corner);
}

// The ridge of a blade of five degrees: what is a bit behind it is near to both planes.
TEST(PatchMerger, KeepsTheRidgeOfABlade) {
  const DefaultFloatingPoint guard;
  constexpr double kBehind = 1.5e-8, kHalf = 0.0437;  // the tangent of half the angle
  const Vec3 lower{1, -1, -kHalf}, upper{1, -1, kHalf};
  SurfacePatch patch;
  patch.vertices = {{0, -kBehind, 0}, {1, 0, 0}, {2, -kBehind, 0}, lower, upper};
  patch.triangles = {{0, 1, 3}, {1, 2, 3}, {1, 0, 4}, {2, 1, 4}, {0, 3, 4}, {3, 2, 4}};
  patch.sources = {0, 0, 1, 1, 2, 3};
  patch.roles.assign(patch.vertices.size(), VertexRole::kFree);
  patch.settled.assign(patch.vertices.size(), 0);
  // The planes meet in the line of the middle vertex.
  const TriangleMesh input{{{0, 0, 0}, {2, 0, 0}, lower, upper, patch.vertices[0], patch.vertices[2]},
                           {{0, 1, 2}, {1, 0, 3}, {4, 2, 3}, {2, 5, 3}}};
  PatchMerger merged(patch, input, {1e-9, 1e-8});
  merged.merge();
  EXPECT_EQ(merged.into()[1], 1U);
  patch.vertices[0].y = patch.vertices[2].y = 0.0;  // on one straight line
  PatchMerger straight(patch, input, {1e-9, 1e-8});
  straight.merge();
  EXPECT_NE(straight.into()[1], 1U);
}

// The border of faces that close a hole stays where it is, also in the plane of what is beside it.
TEST(Surface, KeepsTheBorderOfAHoleWhereFacesAreMerged) {
  // A box whose top has a hole that is no rectangle: what closes it is nearly in the plane of the rest of the top.
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return mesh.vertices[v].z == 1.0; });
  });
  const std::uint32_t first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.37, 0.61, 1}});
  mesh.triangles.insert(mesh.triangles.end(), {{first, first + 1, first + 4}, {first + 1, first + 2, first + 4}});
  const auto hole_area = [](const SurfaceMesh& surface) {
    double area = 0.0;
    for (std::size_t face = 0; face < surface.sources.size(); ++face) {
      if (surface.sources[face] != kHole) continue;
      const Triangle& t = surface.mesh.triangles[face];
      const std::vector<Vec3>& v = surface.mesh.vertices;
      const Vec3 normal = cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
      area += std::sqrt(dot(normal, normal)) / 2;
    }
    return area;
  };
  const TriangleMesh welded = weld(mesh, {});
  const auto [fine, lattice] = surface_of(welded, 20, {.rule = {}, .merge_planes = false});
  const auto [merged, same] = surface_of(welded, 20);
  EXPECT_GT(hole_area(fine), 0.1);
  EXPECT_NEAR(hole_area(merged), hole_area(fine), 1e-6);
}

// Merging goes brick by brick, of 32 voxels each: nothing of their borders is left.
TEST(Surface, OfABoxOfManyBricksHasFewFaces) {
  const auto [aligned, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 80);
  EXPECT_EQ(aligned.mesh.triangles.size(), 12U);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  const auto [turned, turned_lattice] = surface_of(mesh, 80);
  const auto [coarse, coarse_lattice] = surface_of(mesh, 20);
  // Where edges are cut off between outside nodes, faces are left, a number for each voxel of the edges.
  EXPECT_LT(turned.mesh.triangles.size(), 6 * coarse.mesh.triangles.size());
}

// Bricks that meet share vertices, and so would share edges that each of them makes by itself. With limits that are
// wide vertices of curved parts are pulled, too: faces may cross one another then, but every edge is still one of two
// faces.
TEST(MergedFaces, CloseUpWhereBricksMeet) {
  for (const TriangleMesh& mesh : {rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7})), rotated(cylinder())}) {
    const auto [fine, lattice] = surface_of(mesh, 80, {.rule = {}, .merge_planes = false});
    const NodeSet nodes = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
    const std::vector<bool> kept(fine.mesh.vertices.size(), false);
    for (const double most : {1e-9, 0.01, 0.3}) {
      const MergedFaces merged = merge_planes(fine, mesh, lattice, kept, {most * lattice.spacing.x, 0.0});
      EXPECT_LT(4 * merged.triangles.size(), fine.mesh.triangles.size());
      const SurfaceFaults faults = faults_of(compacted(fine.mesh.vertices, merged.triangles), nodes);
      EXPECT_EQ(faults.edges, 0U) << most;
      EXPECT_EQ(faults.links, 0U) << most;
    }
  }
}

// However often faces were merged before, and whatever was kept then.
TEST(MergedFaces, AreTheSameWhateverWasKeptBefore) {
  Random random(6);
  for (const TriangleMesh& mesh : {rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7})), rotated(cylinder())}) {
    const auto [fine, lattice] = surface_of(mesh, 80, {.rule = {}, .merge_planes = false});
    const MergeLimits limits{1e-9 * lattice.spacing.x, 0.0};
    std::vector<bool> kept(fine.mesh.vertices.size(), false);
    PlaneMerger merger(fine, mesh, lattice, limits);
    for (int round = 0; round < 12; ++round) {
      const MergedFaces again = merger.merge(kept), once = merge_planes(fine, mesh, lattice, kept, limits);
      EXPECT_EQ(again.triangles, once.triangles) << round;
      EXPECT_EQ(again.sources, once.sources) << round;
      EXPECT_EQ(again.into, once.into) << round;
      for (int n = 0; n < 1 << round % 6; ++n)
        kept[static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())))].flip();
    }
  }
}

// Each time some vertices are kept others than before, and some are moved, which makes faults, that stay or go.
TEST(RepeatedCheck, FindsWhatFaultsOfFinds) {
  const DefaultFloatingPoint guard;
  Random random(7);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}));
  const auto [fine, lattice] = surface_of(mesh, 40, {.rule = {}, .merge_planes = false});
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  std::vector<bool> kept(fine.mesh.vertices.size(), false);
  std::vector<Vec3> vertices = fine.mesh.vertices;
  const auto any_vertex = [&] {
    return static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())));
  };
  for (std::size_t v = 0; v < kept.size(); ++v) kept[v] = uniform(random, 0.0, 1.0) < 0.5;
  PlaneMerger merger(fine, mesh, lattice, {1e-9 * lattice.spacing.x, 0.0});
  RepeatedCheck check(inside, kept.size());
  int right = 0, wrong = 0, still_wrong = 0;
  std::uint64_t last = 0;
  for (int round = 0; round < 60; ++round) {
    const MergedFaces merged = merger.merge(kept);
    const TriangleMesh now = used_part(vertices, merged.triangles);
    NodeSet misplaced(lattice), expected_nodes(lattice);
    const SurfaceFaults found = check.faults(merged, now, misplaced);
    const SurfaceFaults expected = faults_of(now, inside, &expected_nodes);
    ASSERT_EQ(described(found), described(expected)) << round;
    EXPECT_EQ(found.intersections.of_triangle, expected.intersections.of_triangle) << round;
    EXPECT_EQ(found.intersections.first.has_value(), expected.intersections.first.has_value());
    misplaced.flip(expected_nodes);
    EXPECT_TRUE(misplaced.empty());
    check.remember(merged, now, found);
    ++(found.none() ? right : wrong);
    still_wrong += last > 0 && found.intersections.pairs > 0 ? 1 : 0;
    last = found.intersections.pairs;
    for (int n = 0; n < 3; ++n) kept[any_vertex()].flip();
    if (round % 5 == 0) vertices = fine.mesh.vertices;
    if (round % 5 != 1 && round % 5 != 2) continue;
    const auto face = static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(merged.faces.size())));
    const std::uint32_t moved = merged.triangles[face][0];
    vertices[moved].x += uniform(random, -9.0, 9.0) * lattice.spacing.x;
    kept[moved] = true;
  }
  EXPECT_GT(right, 10);
  EXPECT_GT(wrong, 10);
  EXPECT_GT(still_wrong, 5);
}

// Of a surface that is known to have no faults before: few vertices are merged, and one is moved.
TEST(RepeatedCheck, FindsWhatFaultsOfFindsAfterAWholeSurface) {
  const DefaultFloatingPoint guard;
  Random random(8);
  const TriangleMesh mesh = rotated(test::box_mesh({0, 0, 0}, {1, 1.5, 0.7}));
  const auto [fine, lattice] = surface_of(mesh, 24, {.rule = {}, .merge_planes = false});
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  int right = 0, wrong = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<bool> kept(fine.mesh.vertices.size(), true);
    std::vector<Vec3> vertices = fine.mesh.vertices;
    for (int n = 0; n < 20; ++n)
      kept[static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(kept.size())))] = false;
    const MergedFaces merged = merge_planes(fine, mesh, lattice, kept, {1e-9 * lattice.spacing.x, 0.0});
    const auto face = static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(merged.faces.size())));
    if (round % 2 == 1) vertices[merged.triangles[face][0]].x += uniform(random, -9.0, 9.0) * lattice.spacing.x;
    const TriangleMesh now = used_part(vertices, merged.triangles);
    RepeatedCheck check(inside, kept.size());
    check.remember_whole(fine);
    NodeSet misplaced(lattice);
    const SurfaceFaults found = check.faults(merged, now, misplaced);
    EXPECT_EQ(described(found), described(faults_of(now, inside))) << round;
    ++(found.none() ? right : wrong);
  }
  EXPECT_GT(right, 10);
  EXPECT_GT(wrong, 5);
}

// Whether a vertex among `ring`, all of whose faces are in a patch, is settled there. Each face is its own source. Only
// the vertex itself has all of its faces in it.
bool is_settled_among(const std::vector<Vec3>& ring) {
  SurfacePatch patch{{{0, 0, 0}}, {VertexRole::kFree}, {0}, {}, {}};
  for (std::uint32_t i = 0; i < ring.size(); ++i) {
    patch.vertices.push_back(ring[i]);
    patch.roles.push_back(VertexRole::kForeign);
    patch.settled.push_back(0);
    patch.triangles.push_back({0, 1 + i, 1 + (i + 1) % static_cast<std::uint32_t>(ring.size())});
    patch.sources.push_back(static_cast<std::int32_t>(i));
  }
  const TriangleMesh input{patch.vertices, patch.triangles};
  PatchMerger merger(patch, input, {1e-9, 0.0});
  merger.merge();
  EXPECT_EQ(merger.into()[0], 0U);
  return merger.is_settled(0);
}

// Another brick may pull a vertex along a ridge, or within a plane, whose neighbours are foreign here. None can pull
// one at a corner.
TEST(PatchMerger, SettlesWhatStaysInAnyBrick) {
  EXPECT_FALSE(is_settled_among({{1, 0, 0}, {0, 1, -1}, {-1, 0, 0}, {0, -1, -1}}));
  EXPECT_FALSE(is_settled_among({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}));
  EXPECT_TRUE(is_settled_among({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_TRUE(is_settled_among({{1, 0, -1}, {0, 1, -1}, {-1, 0, -1}, {0, -1, -1}}));
}

// The opening of the box is in a plane of nodes, which are inside. Merged with the rim, which is at these nodes, it
// would leave some of them outside. Without what keeps faces beside these, there are twice as many.
TEST(Surface, IsMergedButAtNodesThatWouldChangeSides) {
  for (const std::int64_t side : {14, 15, 18}) {
    const auto [surface, lattice] = surface_of(test::open_box(), side);
    EXPECT_LT(surface.mesh.triangles.size(), 400U) << side;
  }
}

// Of the rim's 37 nodes, another one would be outside after each round in which those around the last stay: all rounds
// end with faults, and all 62488 faces would be left.
TEST(Surface, IsMergedWhereFaultsMoveAlongAnEdge) {
  const TriangleMesh box = test::open_box();
  const double h = 1.0 / 36.0;
  const Lattice lattice{{0, 0, 0}, {h, h, h}, {-3, -3, -3}, {43, 43, 43}};
  const WindingNumberEvaluator evaluator(box);
  const NodeSet nodes = nodes_inside(evaluator, Rule{}, lattice);
  const FinishedSurface made = closed_surface(box, evaluator, nodes, {});
  EXPECT_TRUE(made.merged);
  EXPECT_TRUE(faults_of(made.surface.mesh, nodes).none());
  EXPECT_LT(made.surface.mesh.triangles.size(), 3000U);
}

// A box across the corners of the lattice: the planes of its sides lead through nodes, its corners are nodes. Points
// there are kept off them, so that faces between these are not quite in the planes: some nodes on them would be on the
// wrong side.
TEST(Surface, HasThePlanesOfTheMeshThroughNodes) {
  for (const double height : {0.7, 1.4142, 3.0}) {
    for (const std::int64_t side : {13, 23, 43}) {
      TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
      for (Vec3& p : box.vertices) p = {1.632993 * (p.x - p.y), 1.632993 * (p.x + p.y - 1), height * p.z};
      EXPECT_EQ(surface_of(box, side).surface.mesh.triangles.size(), 12U) << height << " at " << side;
    }
  }
}

// Both ends are nearer to the triangle's plane than numbers of 64 bits can tell.
TEST(SegmentHit, IsRightWhereTheSegmentIsNearlyInThePlane) {
  Random random(31);
  int hits = 0;
  for (int n = 0; n < 2000; ++n) {
    TriangleMesh mesh{{}, {{0, 1, 2}}};
    const double size = std::exp2(uniform(random, -8, 8));
    for (int corner = 0; corner < 3; ++corner)
      mesh.vertices.push_back(
          {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)});
    const Vec3 &a = mesh.vertices[0], &b = mesh.vertices[1], &c = mesh.vertices[2];
    const double u = uniform(random, 0, 0.5), v = uniform(random, 0, 0.5);
    const Vec3 p = a + u * (b - a) + v * (c - a),
               q = p + uniform(random, 0, 2) * (b - a) + uniform(random, 0, 2) * (c - a);
    const std::optional<double> at = segment_hit(p, q, a, b, c);
    if (!at) continue;
    ++hits;
    const QuadVec3 normal = cross(quad_difference(b, a), quad_difference(c, a));
    const Quad of_p = dot(normal, quad_difference(p, a)), of_q = dot(normal, quad_difference(q, a));
    EXPECT_NEAR(*at, static_cast<double>(of_p / (of_p - of_q)), 1e-14) << n;
    HitFinder finder(mesh);
    std::vector<SegmentHit> found;
    const std::vector<std::uint32_t> all{0};
    finder.enter(p, all);
    finder.find(q, true, found);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].at, *at);
  }
  EXPECT_GT(hits, 300);
}

TEST(MeshCorners, TakeTheNearestVertexEach) {
  const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}}, {{0, 1, 2}}};
  const Lattice lattice{{0, 0, 0}, {0.5, 0.5, 0.5}, {-1, -1, -1}, {5, 5, 5}};
  std::vector<Vec3> vertices{{0.002, 0, 0}, {-0.001, 0, 0}, {0, 0.001, 0}, {1, 0.004, 0}, {0.004, 0.996, -0.006}};
  move_to_corners(mesh, lattice, 0.005, vertices);
  const std::vector<Vec3> expected{{0.002, 0, 0}, {0, 0, 0}, {0, 0.001, 0}, {1, 0, 0}, {0.004, 0.996, -0.006}};
  EXPECT_EQ(vertices, expected);
}

TEST(MeshCorners, GiveAVertexToTheNearestOfThem) {
  const TriangleMesh mesh{{{0, 0, 0}, {0.003, 0, 0}, {0.001, 0.002, 0}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}}};
  const Lattice lattice{{0, 0, 0}, {0.5, 0.5, 0.5}, {-1, -1, -1}, {5, 5, 5}};
  std::vector<Vec3> vertices{{0.002, 0, 0}};
  move_to_corners(mesh, lattice, 0.005, vertices);
  EXPECT_EQ(vertices, (std::vector<Vec3>{{0.003, 0, 0}}));
}

TEST(MeshCorners, LevelPlanesTakeCornersOfTheirFacesAlone) {
  const TriangleMesh mesh{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}}};
  TriangleMesh surface{
      {{0.1, 0.001, 1.001}, {0.5, 0.1, 0.999}, {0.1, 0.5, 1.01}, {0.1, -0.003, 1.5}, {0.9, 0.2, 1.002}},
      {{0, 1, 2}, {1, 0, 3}, {1, 4, 3}, {2, 4, 3}}};
  move_into_level_planes(mesh, {0, 1, 2, kHole}, 0.005, surface);
  const std::vector<Vec3> expected{{0.1, 0, 1}, {0.5, 0.1, 1}, {0.1, 0.5, 1.01}, {0.1, 0, 1.5}, {0.9, 0.2, 1.002}};
  EXPECT_EQ(surface.vertices, expected);
}

// Three tetrahedra stand on a plane of the lattice and pass through each other: their faces meet there at points that
// are no corners.
TEST(Surface, InLevelPlanesThroughNodesHasLargeFaces) {
  const TriangleMesh mesh{{{-2, -2, 0},
                           {-2, 13, 0},
                           {5.5, 5.5, 15},
                           {13, -2, 0},
                           {16, 14, 0},
                           {16, 14, 30},
                           {31, -1, 0},
                           {31, 29, 0},
                           {0, 30, 0},
                           {15, 15, 0},
                           {15, 15, 30},
                           {30, 30, 0}},
                          {{0, 2, 1},
                           {0, 3, 2},
                           {2, 3, 1},
                           {1, 3, 0},
                           {4, 5, 7},
                           {4, 6, 5},
                           {5, 6, 7},
                           {7, 6, 4},
                           {8, 9, 10},
                           {8, 11, 9},
                           {9, 11, 10},
                           {10, 11, 8}}};
  const std::optional<double> volume = mesh_statistics(mesh).signed_volume;
  ASSERT_TRUE(volume && *volume > 0.0);
  const auto [surface, lattice] = surface_of(mesh, 82);
  EXPECT_LT(surface.mesh.triangles.size(), 40U);
}

TriangleMesh octahedron(double radius) {
  TriangleMesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                    {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (Vec3& p : mesh.vertices) p = radius * p;
  return mesh;
}

// Oblique planes through nodes, which rounding has on either side of them.
TEST(Surface, OfPlanesThroughNodesHasTheFacesOfTheMesh) {
  const TriangleMesh tetrahedron{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                 {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  for (const TriangleMesh& mesh : {octahedron(1.0), octahedron(0.1), octahedron(0.001), tetrahedron}) {
    for (const std::int64_t samples : {24, 44, 74, 80, 84}) {
      const auto [surface, lattice] = surface_of(mesh, samples + 2);
      EXPECT_EQ(surface.mesh.triangles.size(), mesh.triangles.size()) << mesh.vertices[0].x << " at " << samples;
    }
  }
}

// The same octahedron, and in a corner of its box a block with a pit that one edge of the lattice leads through. A
// lattice that is moved does not see it.
TEST(Surface, OfPlanesThroughNodesIsWhereEdgesOfTheLatticeLeaveTheMesh) {
  const std::int64_t samples = 80;
  const double h = 2.0 / (samples - 1), x = -1 + 72 * h, top = 0.9375, rim = 0.002;
  TriangleMesh mesh = octahedron(1.0);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const double low = 0.7, high = 0.95;
  for (const double z : {low, top}) {
    for (const Vec3& p : {Vec3{low, low, z}, Vec3{high, low, z}, Vec3{high, high, z}, Vec3{low, high, z}})
      mesh.vertices.push_back(p);
  }
  for (const Vec3& p : {Vec3{x - rim, x - rim, top}, Vec3{x + rim, x - rim, top}, Vec3{x + rim, x + rim, top},
                        Vec3{x - rim, x + rim, top}, Vec3{x + 1e-4, x + 2e-4, 0.93}})
    mesh.vertices.push_back(p);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  };
  add(0, 2, 1);
  add(0, 3, 2);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    add(i, j, 4 + j);
    add(i, 4 + j, 4 + i);
    add(4 + i, 4 + j, 8 + j);
    add(4 + i, 8 + j, 8 + i);
    add(8 + i, 8 + j, 12);
  }
  const auto [surface, lattice] = surface_of(mesh, samples + 2);
  const std::vector<Vec3> in_pit{{x, x, 0.936}};
  std::vector<double> of_mesh(1), of_surface(1);
  WindingNumberEvaluator(mesh).evaluate(in_pit, of_mesh);
  WindingNumberEvaluator(surface.mesh).evaluate(in_pit, of_surface);
  EXPECT_NEAR(of_mesh[0], 0.0, 1e-12);
  EXPECT_NEAR(of_surface[0], 0.0, 1e-12);
}

DroppedSamples dropped_samples(const SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside,
                               double thickness = 0.0, bool own_faces = false) {
  const double farthest = farthest_kept(mesh, inside.lattice(), own_faces, false) + thickness;
  return {surface, inside, thickness, farthest, {}};
}

DroppedArea dropped_of(const SurfaceMesh& surface, const TriangleMesh& mesh, const NodeSet& inside,
                       bool own_faces = false) {
  DroppedSamples dropped = dropped_samples(surface, mesh, inside, 0.0, own_faces);
  return dropped_area(mesh, dropped);
}

TEST(Surface, ClosesAHoleWhereTheWindingNumberPassesTheThreshold) {
  const TriangleMesh mesh = rotated(test::open_box());
  const auto [surface, lattice] = surface_of(mesh, 20);
  std::vector<Vec3> at_hole;
  for (std::size_t i = 0; i < surface.sources.size(); ++i) {
    if (surface.sources[i] == kHole) at_hole.push_back(surface.mesh.vertices[surface.mesh.triangles[i][0]]);
  }
  ASSERT_GT(at_hole.size(), 10U);
  std::vector<double> w(at_hole.size());
  WindingNumberEvaluator(mesh).evaluate(at_hole, w);
  // Points next to the hole's rim are on triangles, the others within 2^-34 of an edge of the right place.
  const auto right = std::ranges::count_if(w, [](double value) { return std::abs(value - 0.5) < 1e-8; });
  EXPECT_GT(static_cast<double>(right), 0.5 * static_cast<double>(w.size()));
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  EXPECT_GT(measure_surface(surface, mesh, lattice).hole_area, 0.0);
}

TEST(Surface, InSinglePrecisionIsRightThere) {
  SurfaceOptions options;
  options.single_precision = true;
  const TriangleMesh mesh = rotated(test::sphere(7));
  for (const auto& [surface, lattice] :
       {surface_of(mesh, 17, options), surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 17, options)}) {
    for (const Vec3& p : surface.mesh.vertices) {
      for (const double x : {p.x, p.y, p.z}) ASSERT_EQ(x, static_cast<double>(static_cast<float>(x)));
    }
  }
}

TEST(Surface, FollowsItsRule) {
  const TriangleMesh twice = test::joined(test::sphere(6), test::moved(test::sphere(6), {1, 1, 1}, {0.4, 0, 0}));
  SurfaceOptions both;
  both.rule = {RuleKind::kThreshold, 1.5};
  const double of_both = mesh_statistics(surface_of(twice, 14, both).surface.mesh).signed_volume.value_or(0.0);
  const double of_any = mesh_statistics(surface_of(twice, 14).surface.mesh).signed_volume.value_or(0.0);
  const double of_one = mesh_statistics(test::sphere(6)).signed_volume.value_or(0.0);
  // Each volume is off by what the lattice rounds: 4 % at 14 samples.
  EXPECT_NEAR(of_both + of_any, 2.0 * of_one, 0.04 * of_one);
  EXPECT_LT(of_both, 0.8 * of_one);
}

// Simplified faces may reach from the mesh into what closes a hole: these are of no triangle.
TEST(Surface, SimplifiedFacesWithASourceAreNearIt) {
  Random random(3);
  TriangleMesh sieve = rotated(weld(test::sphere(24), {}));
  std::erase_if(sieve.triangles, [&](const Triangle&) { return uniform(random, 0.0, 1.0) < 0.1; });
  for (const double simplify : {0.05, 0.01}) {  // voxels are 0.12
    SurfaceOptions options;
    options.simplify = simplify;
    const auto [surface, lattice] = surface_of(sieve, 20, options);
    const NodeSet inside = nodes_inside(WindingNumberEvaluator(sieve), Rule{}, lattice);
    const std::optional<FinishedSurface> own = mesh_as_surface(sieve, WindingNumberEvaluator(sieve), inside, options);
    ASSERT_TRUE(own);
    for (const SurfaceMesh* made : {&surface, &own->surface}) {
      EXPECT_GT(std::ranges::count(made->sources, kHole), 5) << simplify;
      EXPECT_LE(measure_surface(*made, sieve, lattice).max_distance, simplify);
    }
  }
}

TEST(Surface, OfALatticeThatIsTooFineOrOutOfRangeIsRefused) {
  const TriangleMesh mesh = test::moved(test::box_mesh({0, 0, 0}, {1, 1, 1}), {1, 1, 1}, {1e15, 1e15, 1e15});
  EXPECT_THROW(surface_of(mesh, 8), LatticeTooFine);
  SurfaceOptions single;
  single.single_precision = true;
  // So far away that 256 roundings are a fifth of a voxel: there are surfaces all the same.
  const TriangleMesh away = test::moved(test::sphere(8), {1, 1, 1}, {3000, -3000, 2000});
  const auto [surface, lattice] = surface_of(away, 9, single);
  EXPECT_TRUE(faults_of(surface.mesh, nodes_inside(WindingNumberEvaluator(away), Rule{}, lattice)).none());
  for (const double size : {1e-40, 1e-300, 1e39, 1e300}) {
    EXPECT_THROW(surface_of(test::box_mesh({0, 0, 0}, {size, size, size}), 8, single), LatticeOutOfRange) << size;
    EXPECT_NO_THROW(surface_of(test::box_mesh({0, 0, 0}, {size, size, size}), 8)) << size;
  }
  EXPECT_THROW(surface_of(test::box_mesh({0, 0, 0}, {1e-321, 1e-321, 1e-321}), 8), LatticeOutOfRange);
}

TEST(SurfaceMeasures, TellWhatSeparatesNothing) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh wall = box;
  wall.vertices.insert(wall.vertices.end(), {{0.5, 0.2, 0.2}, {0.5, 0.8, 0.2}, {0.5, 0.2, 0.8}});
  const auto first = static_cast<std::uint32_t>(box.vertices.size());
  wall.triangles.push_back({first, first + 1, first + 2});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  EXPECT_NEAR(dropped_of(surface, wall, inside).area, 0.18, 1e-12);
  EXPECT_EQ(dropped_of(surface, box, inside).area, 0.0);
  EXPECT_TRUE(dropped_of(surface, wall, inside).is_some);
  EXPECT_FALSE(dropped_of(surface, box, inside).is_some);
}

// A sheet in a box, so far from faces that are the mesh's own.
TEST(SurfaceMeasures, TellFacesNextToTheSurfaceFromItsOwn) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const auto dropped_at = [&, &surface = surface](double voxels) {
    const double x = voxels * lattice.spacing.x;
    TriangleMesh mesh = box;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0.2, 0.2}, {x, 0.8, 0.2}, {x, 0.2, 0.8}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    return dropped_of(surface, mesh, inside, true).area;
  };
  EXPECT_EQ(dropped_at(0.001), 0.0);
  EXPECT_NEAR(dropped_at(0.01), 0.18, 1e-12);
}

// Far from the origin, in double precision.
TEST(SurfaceMeasures, AreAsFineFarAway) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1}), far = test::moved(box, {1, 1, 1}, {1e6 + 0.1, 0, 0});
  const auto lattice_of = [](const TriangleMesh& mesh) {
    return Lattice{bounding_box(mesh).lower, {0.1, 0.1, 0.1}, {-1, -1, -1}, {12, 12, 12}};
  };
  const auto off = [&](const TriangleMesh& mesh, bool single) {
    return farthest_kept(mesh, lattice_of(mesh), true, single);
  };
  EXPECT_NEAR(off(box, false), 2e-4, 1e-4);  // 2^-9 voxels
  EXPECT_NEAR(off(far, false), 2e-4, 1e-4);
  EXPECT_NEAR(off(far, true), 0.25 * 0.1 * std::sqrt(3.0), 1e-9);  // more is too much in any case
}

// Many are looked at together. Each is as its own distance says.
TEST(SurfaceMeasures, DropWhatIsFarPointByPoint) {
  Random random(41);
  const auto [surface, lattice] = surface_of(test::box_mesh({0, 0, 0}, {1, 1, 1}), 20);
  TriangleMesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto point = [&](double most) {
    return Vec3{uniform(random, -most, most), uniform(random, -most, most), uniform(random, -most, most)};
  };
  for (std::uint32_t n = 0; n < 300; ++n) {  // large ones, small ones, and needles, in and out of the box
    const Vec3 a = Vec3{0.5, 0.5, 0.5} + point(0.7), to_b = point(n % 3 == 0 ? 0.9 : 0.05), to_c = point(0.05);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, a + to_b, n % 7 == 0 ? mesh.vertices[0] : a + to_c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), Rule{}, lattice);
  for (const bool own_faces : {false, true}) {
    DroppedSamples dropped = dropped_samples(surface, mesh, inside, 0.25 * lattice.spacing.x, own_faces);
    const double farthest = farthest_kept(mesh, lattice, own_faces, false) + 0.25 * lattice.spacing.x;
    std::size_t count = 0, far = 0;
    dropped.for_each(mesh, [&](const AreaSamples& samples, const std::vector<bool>& is_dropped) {
      std::vector<double> distances(samples.points.size());
      DistanceEvaluator(surface.mesh).evaluate(samples.points, distances);
      for (std::size_t n = 0; n < is_dropped.size(); ++n) ASSERT_EQ(is_dropped[n], distances[n] > farthest) << n;
      count += is_dropped.size();
      far += static_cast<std::size_t>(std::ranges::count(is_dropped, true));
    });
    EXPECT_GT(count, 10000U);
    EXPECT_GT(far, count / 4);
    EXPECT_LT(far, 3 * count / 4);
  }
}

// A triangle as one, and as a fan of needles, has the same area.
TEST(SurfaceMeasures, AddUpNeedles) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  TriangleMesh needles = box;
  const auto first = static_cast<std::uint32_t>(box.vertices.size());
  needles.vertices.push_back({0.5, 0.2, 0.2});
  constexpr std::uint32_t kNeedles = 200;
  for (std::uint32_t n = 0; n <= kNeedles; ++n) {
    needles.vertices.push_back({0.5, 0.8 - 0.6 * n / kNeedles, 0.2 + 0.6 * n / kNeedles});
    if (n > 0) needles.triangles.push_back({first, first + n, first + n + 1});
  }
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  EXPECT_NEAR(dropped_of(surface, needles, inside).area, 0.18, 1e-12);  // a sum of some thousand parts
}

// They find most distances without a search.
TEST(SurfaceMeasures, AreTheLargestDistanceFromTheMesh) {
  Random random(26);
  for (int round = 0; round < 6; ++round) {
    const TriangleMesh mesh = rotated(round % 2 == 0 ? test::open_box() : test::sphere(9));
    SurfaceOptions options;
    options.single_precision = round > 3;
    auto [surface, lattice] = surface_of(mesh, 16 + round, options);
    // Some vertices off the mesh, as nothing makes them: not what their sources say.
    if (round % 3 == 2) surface.mesh.vertices[surface.mesh.triangles[7][0]].x += 3.0 * lattice.spacing.x;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < surface.sources.size(); ++i) {
      if (surface.sources[i] == kHole) continue;
      for (const std::uint32_t corner : surface.mesh.triangles[i]) points.push_back(surface.mesh.vertices[corner]);
    }
    EXPECT_EQ(measure_surface(surface, mesh, lattice).max_distance, largest_distance_of(points, mesh)) << round;
  }
}

// Where products of lengths overflow, and where another part is so far away that distances round to voxels.
TEST(SurfaceMeasures, DoNotDependOnUnitsAndFarParts) {
  TriangleMesh box = rotated(test::box_mesh({0, 0, 0}, {1, 1, 1}));
  for (Triangle& t : box.triangles) {  // first the corner with the right angle
    const auto is_right = [&] {
      const Vec3& at = box.vertices[t[0]];
      return std::abs(dot(box.vertices[t[1]] - at, box.vertices[t[2]] - at)) < 0.5;
    };
    while (!is_right()) std::ranges::rotate(t, t.begin() + 1);
  }
  auto [surface, lattice] = surface_of(box, 12);
  surface.mesh.vertices[surface.mesh.triangles[7][0]].x += 0.125;
  const double expected = measure_surface(surface, box, lattice).max_distance;
  EXPECT_GT(expected, 0.01);
  for (const int exponent : {-300, 270, 332, 600}) {
    const double unit = std::ldexp(1.0, exponent);
    SurfaceMesh scaled = surface;
    scaled.mesh = test::moved(scaled.mesh, {unit, unit, unit}, {});
    Lattice here = lattice;
    here.origin = unit * here.origin;
    here.spacing = unit * here.spacing;
    EXPECT_EQ(measure_surface(scaled, test::moved(box, {unit, unit, unit}, {}), here).max_distance, unit * expected);
  }
  for (const double far : {1e30, 1e90}) {
    const TriangleMesh two = test::joined(box, test::box_mesh({far, far, far}, {2 * far, 2 * far, 2 * far}));
    // As far as sources tell: the nearest triangle may be another one.
    const double found = measure_surface(surface, two, lattice).max_distance;
    EXPECT_GE(found, expected * (1 - 1e-9)) << far;
    EXPECT_LE(found, 0.125) << far;
  }
}

// No power of two takes both to where nothing over- or underflows.
TEST(Surface, RefusesCoordinatesTooFarApart) {
  TriangleMesh box = test::moved(test::box_mesh({0, 0, 0}, {1, 1, 1}), {0x1p400, 0x1p400, 0x1p400}, {});
  EXPECT_NO_THROW(surface_of(box, 12));
  box.vertices[0].x = 1e-300;
  EXPECT_THROW(surface_of(box, 12), LatticeOutOfRange);
}

// A box beside a plate of a tenth of a voxel, which lies between nodes.
TEST(SurfaceMeasures, TellWhatIsTooThin) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const auto thin = [&, &surface = surface](const TriangleMesh& other, double thickness) {
    TriangleMesh mesh = box;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const WindingNumberEvaluator evaluator(mesh);
    DroppedSamples dropped = dropped_samples(surface, mesh, inside, thickness);
    return thin_parts(mesh, RuleAlong(evaluator, Rule{}), dropped);
  };
  const double h = lattice.spacing.x;
  // A gap within the box, and the same faces the other way round, which separate nothing there.
  const TriangleMesh plate = test::box_mesh({0.3, 0.3, 0.5}, {0.7, 0.7, 0.5 + 0.1 * h});
  TriangleMesh gap = plate;
  for (Triangle& t : gap.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(thin(plate, 0.0).area, 0.0);
  EXPECT_EQ(thin(plate, 0.0).lost, 0U);
  EXPECT_NEAR(thin(gap, 0.0).area, 2 * 0.16 + 4 * 0.4 * 0.1 * h, 1e-12);
  EXPECT_EQ(thin(gap, 0.0).lost, 1U);
  EXPECT_EQ(thin(gap, h / 4).area, 0.0);  // within the set
  // Beyond the lattice, nothing counts.
  EXPECT_EQ(thin(test::moved(gap, {1, 1, 1}, {5, 0, 0}), 0.0).area, 0.0);
  EXPECT_EQ(thin(test::moved(plate, {1, 1, 1}, {5, 0, 0}), h / 4).area, 0.0);
}

// Nearer to what is left than a cell's diagonal, and still lost.
TEST(SurfaceMeasures, TellComponentsThatNoFaceIsOf) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 20);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const double h = lattice.spacing.x;
  const TriangleMesh cavity =
      test::joined(box, test::reversed(test::box_mesh({0.3, 0.3, 0.2 * h}, {0.7, 0.7, 0.6 * h})));
  const double area = 2 * 0.16 + 4 * 0.4 * 0.4 * h;
  EXPECT_NEAR(dropped_of(surface, cavity, inside).area, area, 1e-12);
  DroppedSamples dropped = dropped_samples(surface, cavity, inside);
  const WindingNumberEvaluator evaluator(cavity);
  const ThinParts thin = thin_parts(cavity, RuleAlong(evaluator, Rule{}), dropped);
  EXPECT_NEAR(thin.area, area, 1e-12);
  EXPECT_EQ(thin.lost, 1U);
  // What is there twice is not lost, but for what is off.
  const TriangleMesh twice = test::joined(box, test::moved(box, {1, 1, 1}, {1e-4 * h, 0, 0}));
  EXPECT_EQ(dropped_of(surface, twice, inside).area, 0.0);
}

// Where they are many, one is asked about for several.
TEST(SurfaceMeasures, AddUpManyThinParts) {
  const TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const auto [surface, lattice] = surface_of(box, 128);
  const NodeSet inside = nodes_inside(WindingNumberEvaluator(box), Rule{}, lattice);
  const double h = lattice.spacing.x;
  TriangleMesh mesh = box;
  constexpr int kGaps = 40;
  for (int n = 0; n < kGaps; ++n) {
    const double z = (n + 30) * h;
    mesh = test::joined(mesh, test::reversed(test::box_mesh({0.2, 0.2, z + 0.2 * h}, {0.8, 0.8, z + 0.3 * h})));
  }
  DroppedSamples dropped = dropped_samples(surface, mesh, inside);
  EXPECT_GT(dropped_area(mesh, dropped).samples, std::uint64_t{1} << 18);
  const WindingNumberEvaluator evaluator(mesh);
  const ThinParts thin = thin_parts(mesh, RuleAlong(evaluator, Rule{}), dropped);
  EXPECT_NEAR(thin.area, kGaps * (2 * 0.36 + 4 * 0.6 * 0.1 * h), 1e-9);  // a sum of some 500 000
  EXPECT_EQ(thin.lost, std::uint64_t{kGaps});
}

}  // namespace
}  // namespace raycone
