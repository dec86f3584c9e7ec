// Nodes, points and surfaces that several tests of surfaces start from.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "core/cells/edge_points.h"
#include "core/cells/surface_cells.h"
#include "core/contour/face_points.h"
#include "core/surface/surface.h"
#include "tests/support/shapes.h"

namespace raycone::test {

inline constexpr double kSurfaceMargin = 0x1p-30;  // that of double precision near the origin

// Of side^3 nodes; neither at the origin nor with all its first indices at 0.
Lattice lattice_off_origin(std::int64_t side, double spacing = 1.0);

// The nodes where `inside` holds, which gets their indices counted from the first one; none of the outermost layer.
NodeSet nodes_where(const Lattice& lattice,
                    const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& inside);

// On all mixed edges.
std::vector<EdgePoint> random_edge_points(const SurfaceCells& cells, Random& random, bool to_margin);

// On half of the mixed faces, anywhere within.
FacePoints random_face_points(const SurfaceCells& cells, Random& random);

// As misplaced_vertices() of all vertices of a contour without spare points.
std::uint64_t misplaced(std::span<const Vec3> vertices, const SurfaceCells& cells, const FacePoints& face_points,
                        std::span<const std::uint64_t> tetrahedra);

// Without the faces that a change has taken out.
TriangleMesh without_gone(TriangleMesh mesh);

// With no vertices but those that triangles have.
TriangleMesh compacted(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

// By angles that are no special ones.
TriangleMesh rotated(TriangleMesh mesh);

// What closed_surface() makes, checked, and of which lattice.
struct Made {
  SurfaceMesh surface;
  Lattice lattice;
};

// With about `side` nodes along the longest side of the mesh's box.
Made surface_of(const TriangleMesh& mesh, std::int64_t side, const SurfaceOptions& options = {});

// Of the points from the mesh.
double largest_distance_of(const std::vector<Vec3>& points, const TriangleMesh& mesh);

// Signed, of a closed mesh.
double volume_of(const TriangleMesh& mesh);

// The faces of a sphere of so many rings whose middle is where `has` holds.
TriangleMesh part_of_sphere(int rings, const std::function<bool(const Vec3&)>& has);
// A sphere with a hole whose border goes up and down: where that is steep, its caps are in front of faces beside it.
TriangleMesh bitten_sphere(int rings, double height, double depth, double times, double at = 0.0);

// A prism over a polygon that is nearly round.
TriangleMesh cylinder();

}  // namespace raycone::test
