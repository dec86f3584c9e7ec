// Whether a surface is what it is said to be.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/cells/node_set.h"
#include "core/certificate/surface_edit.h"
#include "core/data/triangle_mesh.h"
#include "core/intersections/self_intersections.h"

namespace raycone {

// What is wrong with a mesh; all of it 0 where it is right.
struct SurfaceFaults {
  std::uint64_t edges = 0;             // that are not of two faces in opposite directions
  std::uint64_t links = 0;             // vertices whose faces are no single fan around them
  std::uint64_t degenerate_faces = 0;  // of zero area
  std::uint64_t equal_vertices = 0;    // at the position of another one
  std::uint64_t nodes = 0;             // of the lattice on the wrong side
  std::uint64_t places = 0;            // vertices of a contour that are not inside of what they lie in
  SelfIntersections intersections{};

  [[nodiscard]] bool none() const {
    return edges + links + degenerate_faces + equal_vertices + nodes + places + intersections.pairs == 0;
  }
};

// Looks for all of them but places, exactly. So a mesh without faults is closed, a 2-manifold and free of
// self-intersections, with the `inside` nodes of the lattice, and no others, behind its fronts. Every vertex is of a
// triangle. Sets `misplaced`, where given, to the nodes on the wrong side: misplaced_nodes().
[[nodiscard]] SurfaceFaults faults_of(const TriangleMesh& mesh, const NodeSet& inside, NodeSet* misplaced = nullptr);

// Whether a mesh has none of these faults, but for nodes and places. Sooner where it has any.
[[nodiscard]] bool is_closed_and_embedded(const TriangleMesh& mesh);

// The vertices at these faults, in increasing order. Takes longer, as it looks for all.
[[nodiscard]] std::vector<std::uint32_t> vertices_at_faults(const TriangleMesh& mesh);

// The nodes of the lattice that are on the other side of a closed mesh than `inside` has them.
// `edges`: its exterior edges, where known, to spare finding them.
[[nodiscard]] NodeSet misplaced_nodes(const TriangleMesh& mesh, const NodeSet& inside,
                                      const std::vector<ExteriorEdge>* edges = nullptr);

// Faults where a mesh has been changed, and the vertices at them.
struct NearFaults {
  SurfaceFaults faults;
  std::vector<std::uint32_t> vertices;  // increasing; not those of misplaced nodes
};

// The faults that faults_of() finds in a mesh since it was changed: each that a changed face has part in, and equal
// vertices nearby. An edge that is wrong counts as two vertices whose faces are no cycle. Sorts what is near the
// change, after a look at each face, in a bit or more per cell of the lattice. `mesh`: after the change; within the
// lattice, or not far from it; without the faces that are gone, and the vertices that no face has. But for nodes: these
// are changed_nodes().
[[nodiscard]] NearFaults faults_near(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice);

// The nodes of a lattice that a mesh goes around an odd number of times more, or less, since it was changed: that were
// on the other side of it, where it does not pass through itself, now or before. What follows one after the other adds
// up: of several changes, a node has changed sides if an odd number of them has it. Precondition: the mesh is closed,
// and was so before.
[[nodiscard]] NodeSet changed_nodes(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice);

// "3 edges without a twin, 1 pairs of faces that intersect"
[[nodiscard]] std::string described(const SurfaceFaults& faults);

}  // namespace raycone
