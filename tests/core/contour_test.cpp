// The surface between nodes, for any labels of nodes and any points: closed, embedded, and right at each node.
#include "core/contour/contour.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "core/cells/surface_cells.h"
#include "core/certificate/certificate.h"
#include "core/machine/floating_point.h"
#include "tests/core/surface_cases.h"
#include "tests/support/exact_intersections.h"
#include "tests/support/shapes.h"

namespace raycone {
namespace {

using test::kSurfaceMargin;
using test::lattice_off_origin;
using test::misplaced;
using test::nodes_where;
using test::Random;
using test::random_edge_points;
using test::random_face_points;
using test::uniform;

// Face points next to the margin of others would need a wider one: rounding then spoils what is thin twice over. Such
// points are dropped by closed_surface().
SurfaceFaults faults_of_random_surface(const NodeSet& nodes, Random& random, bool with_face_points) {
  const DefaultFloatingPoint guard;
  const SurfaceCells cells(nodes);
  const std::vector<EdgePoint> points = random_edge_points(cells, random, !with_face_points);
  const FacePoints face_points = with_face_points ? random_face_points(cells, random) : FacePoints();
  const auto [surface, tetrahedra, first_apex, fewer] = contour({cells, points, {}, 0.0, kSurfaceMargin}, face_points);
  SurfaceFaults faults = faults_of(surface.mesh, nodes);
  faults.places = misplaced(surface.mesh.vertices, cells, face_points, tetrahedra);
  return faults;
}

// Of the eight nodes of a cell, all others are outside.
NodeSet nodes_of_label(unsigned label) {
  return nodes_where(lattice_off_origin(4), [&](auto i, auto j, auto k) {
    return (label >> static_cast<unsigned>((i - 1) + 2 * (j - 1) + 4 * (k - 1)) & 1U) != 0;
  });
}

TEST(Contour, IsRightForEachLabellingOfACell) {
  Random random(1);
  for (unsigned label = 1; label < 256; ++label) {
    for (const bool with_face_points : {false, true}) {
      const SurfaceFaults faults = faults_of_random_surface(nodes_of_label(label), random, with_face_points);
      ASSERT_TRUE(faults.none()) << label << ": " << described(faults);
    }
  }
}

// By the definition, for all pairs of triangles in rational numbers, which takes its time.
TEST(Contour, IsFreeOfIntersectionsByTheDefinition) {
  const DefaultFloatingPoint guard;
  Random random(3);
  for (unsigned label = 1; label < 256; label += 17) {
    const NodeSet nodes = nodes_of_label(label);
    const SurfaceCells cells(nodes);
    for (const bool with_face_points : {false, true}) {
      const std::vector<EdgePoint> points = random_edge_points(cells, random, !with_face_points);
      const FacePoints face_points = with_face_points ? random_face_points(cells, random) : FacePoints();
      TriangleMesh mesh = contour({cells, points, {}, 0.0, kSurfaceMargin}, face_points).surface.mesh;
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

TEST(Contour, IsRightForRandomLabels) {
  Random random(2);
  for (int round = 0; round < label_rounds(); ++round) {
    const double density = uniform(random, 0.05, 0.95);
    const NodeSet nodes = nodes_where(lattice_off_origin(3 + round % 5, round % 2 == 0 ? 1.0 : 0.013),
                                      [&](auto, auto, auto) { return uniform(random, 0.0, 1.0) < density; });
    if (nodes.empty()) continue;
    const SurfaceFaults faults = faults_of_random_surface(nodes, random, round % 3 != 0);
    ASSERT_TRUE(faults.none()) << round << ": " << described(faults);
  }
}

}  // namespace
}  // namespace raycone
