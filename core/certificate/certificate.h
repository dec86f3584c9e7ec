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

// How many things are wrong with a mesh; all 0 where it is right.
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

// Looks for all faults but `places`, exactly. A mesh without faults is closed, a 2-manifold and free of
// self-intersections, has the `inside` nodes of the lattice, and no others, behind its fronts, and no vertex without a
// triangle. Sets `misplaced`, where given, to the nodes on the wrong side: misplaced_nodes().
[[nodiscard]] SurfaceFaults faults_of(const TriangleMesh& mesh, const NodeSet& inside, NodeSet* misplaced = nullptr);

// Whether a mesh has none of these faults, nodes and places aside. Faster where it has some.
[[nodiscard]] bool is_closed_and_embedded(const TriangleMesh& mesh);

// The vertices at faults of these kinds, in increasing order. Slower, as it looks for all.
[[nodiscard]] std::vector<std::uint32_t> vertices_at_faults(const TriangleMesh& mesh);

// The nodes of the lattice that a closed mesh has on the other side than `inside` does. `edges`: its exterior edges, to
// spare finding them; null: not known.
[[nodiscard]] NodeSet misplaced_nodes(const TriangleMesh& mesh, const NodeSet& inside,
                                      const std::vector<ExteriorEdge>* edges = nullptr);

// Faults where a mesh has been changed, and the vertices at them.
struct NearFaults {
  SurfaceFaults faults;
  std::vector<std::uint32_t> vertices;  // increasing; not those of misplaced nodes
};

// The faults that a mesh has since it was changed: each that a changed face has part in, and equal vertices nearby.
// Nodes are not among them: changed_nodes() finds these. A wrong edge counts as two links. `mesh`: after the change;
// within the lattice, or not far from it. Faces that are gone, and vertices that no face has, are ignored. Looks at
// each face once, and sorts what is near the change, in a bit or more per cell of the lattice.
[[nodiscard]] NearFaults faults_near(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice);

// The nodes of a lattice that changed sides when a mesh was changed: the mesh goes around them an odd number of times
// more, or less, than before. So of several changes in a row, a node has changed sides if an odd number of them has it.
// Where the mesh passes through itself, before or after, a node may be counted that did not change sides. `mesh`: after
// the change. Precondition: the mesh is closed, and was so before.
[[nodiscard]] NodeSet changed_nodes(const TriangleMesh& mesh, const SurfaceEdit& change, const Lattice& lattice);

// "3 edges without a twin, 1 pairs of faces that intersect"
[[nodiscard]] std::string described(const SurfaceFaults& faults);

}  // namespace raycone
