// Strips of a surface that are pulled to the edges of the mesh.
#include "core/sharpening/sharpen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/distance/distance.h"
#include "core/machine/floating_point.h"
#include "core/mesh/mesh_statistics.h"
#include "core/sharpening/checked_sharpen.h"
#include "core/surface/face_sources.h"
#include "tests/core/surface_cases.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::without_gone;

// Those that a surface has had before spare ones were added.
TriangleMesh first_of(const TriangleMesh& mesh, const TriangleMesh& before) {
  TriangleMesh first = without_gone(mesh);
  first.vertices.resize(before.vertices.size());
  return first;
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
  const SharpenLimits limits{1e-9, 0.2};
  const DistanceEvaluator from_cut(cut), from_whole(whole_box);
  Sharpener of_cut(surface, {cut, TriangleNormals(cut), from_cut}, limits);
  static_cast<void>(of_cut.sharpen());
  EXPECT_EQ(of_cut.pulls(), 0U);
  for (std::int32_t& source : surface.sources) source %= 24;  // triangles of the whole boxes
  SourceSettler(whole_box, TriangleNormals(whole_box), from_whole, 0.01).settle(surface);
  Sharpener of_whole(surface, {whole_box, TriangleNormals(whole_box), from_whole}, limits);
  of_whole.sharpen();
  EXPECT_EQ(of_whole.pulls(), 1U);  // the gap between four planes
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 2.0, 1e-12);
  // One end of the cut stays: so does what would be pulled into it. The other one is pulled.
  of_whole.keep({0}, Sharpener::Kept::kPulled);
  EXPECT_EQ(of_whole.pulls(), 1U);
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 2.0 - 0.005 / 3, 1e-12);
  of_whole.keep({0}, Sharpener::Kept::kStrips);
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
  Sharpener sharpener(surface, {whole, TriangleNormals(whole), distance}, {1e-9, 0.2});
  sharpener.sharpen();
  ASSERT_EQ(sharpener.pulls(), 2U);
  const SurfaceEdit change = sharpener.keep({0, 1, 2, 3}, Sharpener::Kept::kPulled);
  EXPECT_EQ(sharpener.pulls(), 1U);
  EXPECT_EQ(change.vertices.size(), 2U);
  EXPECT_NEAR(mesh_statistics(without_gone(surface.mesh)).signed_volume.value_or(0.0), 4.0 - 0.005, 1e-12);
  // Faults that are left where nothing changes any more would else not be found.
  const SurfaceEdit no_change = sharpener.keep({0, 1, 2, 3}, Sharpener::Kept::kPulled);
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
  const NodeSet inside(lattice);
  return checked_sharpen(cut.surface, {cut.input, TriangleNormals(cut.input), DistanceEvaluator(cut.input)}, inside,
                         {1e-9, 0.2}, rounds);
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

// Along random directions, at right angles.
std::array<Vec3, 3> random_axes(test::Random& random) {
  std::normal_distribution<double> any;
  const auto direction = [&] { return Vec3{any(random), any(random), any(random)}; };
  const auto unit = [](const Vec3& v) { return (1.0 / norm(v)) * v; };
  const Vec3 u = unit(direction()), w = unit(cross(u, direction()));
  return {u, cross(w, u), w};
}

// A prism over a star-shaped polygon, along no axis.
TriangleMesh star_prism(test::Random& random) {
  std::uniform_real_distribution<double> radius(0.3, 1.3), height(0.3, 1.3), step(0.3, 1.0);
  const auto count = static_cast<std::uint32_t>(5 + random() % 6);
  std::vector<double> angles;
  double all = 0.0;
  for (std::uint32_t n = 0; n < count; ++n) angles.push_back(all += step(random));
  const auto [u, v, w] = random_axes(random);
  const Vec3 up = height(random) * w;
  TriangleMesh mesh{{{0, 0, 0}, up}, {}};
  for (std::uint32_t n = 0; n < count; ++n) {
    const double angle = 2.0 * std::numbers::pi * angles[n] / all, r = radius(random);
    const Vec3 p = r * std::cos(angle) * u + r * std::sin(angle) * v;
    mesh.vertices.push_back(p);
    mesh.vertices.push_back(p + up);
    const std::uint32_t a = 2 + 2 * n, b = 2 + 2 * ((n + 1) % count);
    mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return mesh;
}

// Where triangles cross edges between a node that is inside and one that is not, but for what they meet at borders.
std::vector<Vec3> crossings_of_mixed_edges(const TriangleMesh& mesh, const NodeSet& inside) {
  const Lattice& lattice = inside.lattice();
  std::vector<Vec3> points;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c], normal = cross(q - p, r - p);
    const auto is_left = [&](const Vec3& at, const Vec3& from, const Vec3& to) {
      return dot(cross(to - from, at - from), normal) > 0.0;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int along = static_cast<int>(axis);
      NodeSet::Node last{lattice.counts[0], lattice.counts[1], lattice.counts[2]};
      --last[axis];
      for (NodeSet::Node n{}; n[2] < last[2]; ++n[2]) {
        for (n[1] = 0; n[1] < last[1]; ++n[1]) {
          for (n[0] = 0; n[0] < last[0]; ++n[0]) {
            NodeSet::Node end = n;
            ++end[axis];
            if (inside.holds(n[0], n[1], n[2]) == inside.holds(end[0], end[1], end[2])) continue;
            Vec3 at = lattice.position(
                {n[0] + lattice.index_min[0], n[1] + lattice.index_min[1], n[2] + lattice.index_min[2]});
            const double way = dot(p - at, normal) / normal[along];
            if (!(way >= 0.0 && way <= lattice.spacing[along])) continue;
            at[along] += way;
            if (is_left(at, p, q) && is_left(at, q, r) && is_left(at, r, p)) points.push_back(at);
          }
        }
      }
    }
  }
  return points;
}

// Three of these prisms had faces that crossed the lattice half a voxel off the mesh.
TEST(Sharpening, CrossesTheLatticeOnTheMesh) {
  test::Random random(11);
  for (int n = 0; n < 100; ++n) {
    const TriangleMesh mesh = star_prism(random);
    for (const bool merge : {false, true}) {
      SurfaceOptions options;
      options.merge_planes = merge;
      const test::Made made = test::surface_of(mesh, 9, options);
      const NodeSet inside = nodes_inside(WindingNumberEvaluator(mesh), {}, made.lattice);
      const std::vector<Vec3> crossings = crossings_of_mixed_edges(made.surface.mesh, inside);
      ASSERT_FALSE(crossings.empty());
      // Vertices are within four margins, of up to 2^-18 voxels, of the mesh.
      EXPECT_LE(test::largest_distance_of(crossings, mesh), 0x1p-16 * made.lattice.spacing.x) << n << " " << merge;
    }
  }
}

}  // namespace
}  // namespace raycone
