// The closed surface between the inside and the outside nodes of a lattice.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/cells/edge_roots.h"
#include "core/cells/node_set.h"
#include "core/cells/surface_mesh.h"
#include "core/data/coordinate_precision.h"
#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

struct SurfaceOptions {
  Rule rule;
  double thickness = 0.0;    // the set has grown by this distance from the mesh, world units
  bool merge_planes = true;  // faces of one plane, which changes no point of the surface
  double simplify = 0.0;     // after that, how far the surface may move, world units
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices
  int rounds = 16;                                               // of simplifying, until the surface stays as it was
  // Told what begins, in a few words that stay valid, on the caller's thread.
  std::function<void(const char*)> at_stage{};
};

// What a surface is made of, which must stay meanwhile.
struct SurfaceInput {
  const TriangleMesh& mesh;
  FineAndRough evaluators;  // of the mesh
  const NodeSet& inside;
  const SurfaceOptions& options;
};

// What else there is to know of a surface whose faces are the mesh's own, or parts of these.
struct OwnFaces {
  // Of each triangle of the mesh whether all of it was part of the surface, until faces of a plane were merged. Empty
  // where none is known to be.
  std::vector<bool> held{};
  // Components of the mesh's border that are left out: the lattice does not see them, or what they are within.
  std::uint64_t left_out = 0;
  double left_out_of_all = 0.0;  // the area of these, and of other parts too thin, as a part of the mesh's
};

struct FinishedSurface {
  SurfaceMesh surface;
  // Whether that was done as asked. Else too many rounds of undoing what intersects, or has nodes on the wrong side,
  // left faults still: the surface is the one before.
  bool merged = true, simplified = true;
  bool bound_too_small = false;   // why it is not simplified: `simplify` is within what rounding needs
  std::optional<OwnFaces> own{};  // none: a contour
};

// A surface with faults, in spite of all: an error of the program. what() says which.
class SurfaceFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The shortest side of a cell is so small beside the largest coordinate of the lattice, along whichever axis, that
// coordinates cannot tell nodes apart.
class LatticeTooFine : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The lattice is so large, or so small, that coordinates cannot hold it.
class LatticeOutOfRange : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The surface that separates `inside`, which nodes_inside() found by an evaluator of `mesh` and the rule, and where it
// has a thickness insert_near(), from the other nodes: closed, oriented outward, 2-manifold, without
// self-intersections; all of that has been checked, exactly, on the vertices returned. They lie on the mesh (where the
// source is a triangle) or where the winding number passes a threshold of the rule (kHole), off by four margins of the
// longest spacing at most, or plane_tolerance(); the margin is surface_margin(), and 64 times as much, then 4096 times,
// where a surface has faults. With `simplify` no point of the surface is farther than that from the surface without,
// nor the other way round. A face has a source whose plane it is in, as nearly; one that cuts an edge off has one near
// to its middle. The same for any number of threads. Preconditions: !inside.empty(), !inside.reaches_border();
// `mesh` is welded and its used vertices are finite. Throws SurfaceFailure, LatticeTooFine,
// LatticeOutOfRange, std::length_error for more than 2^31 - 1 faces.
[[nodiscard]] FinishedSurface closed_surface(const SurfaceInput& input);

// The margin that a lattice is given at first, as a fraction of a voxel.
[[nodiscard]] double surface_margin(const Lattice& lattice, CoordinatePrecision precision);

// What closed_surface() and measure_surface() are likely to take at most, in bytes, of a mesh of so many triangles,
// beside `inside` and the mesh: an estimate; peaks of whole processes were 0.8 to 2 times it. Takes no memory and
// little time. Precondition: !inside.reaches_border().
[[nodiscard]] double surface_bytes(const NodeSet& inside, std::size_t triangles);

}  // namespace raycone
