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
  bool merge_planes = true;  // merge faces of one plane, which changes no point of the surface
  double simplify = 0.0;     // after that, how far the surface may move, world units
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of vertices
  int rounds = 16;                                               // of checked_simplify(), at most
  // Told what begins, in a few words that stay valid, on the caller's thread.
  std::function<void(const char*)> at_stage{};
};

// What a surface is made of. All of it must outlive the call, and stay as it is.
struct SurfaceInput {
  const TriangleMesh& mesh;
  FineAndRough evaluators;  // of the mesh
  const NodeSet& inside;
  const SurfaceOptions& options;
};

// What else is known of a surface whose faces are the mesh's own, or parts of these.
struct OwnFaces {
  // Of each triangle of the mesh, whether all of it was part of the surface before faces of a plane were merged. Empty
  // where none is known to be.
  std::vector<bool> held{};
  // Components of the mesh's border that are left out: the lattice does not see them, or not those that they are
  // within.
  std::uint64_t left_out = 0;
  double left_out_of_all = 0.0;  // their area, and that of other parts too thin, as a fraction of the mesh's
};

struct FinishedSurface {
  SurfaceMesh surface;
  // Whether faces were merged, and simplified, as asked for. Where not, too many rounds of undoing what intersects, or
  // has nodes on the wrong side, still left faults: the surface is the one before that step.
  bool merged = true, simplified = true;
  bool bound_too_small = false;   // `simplified` is false because `simplify` is less than rounding needs
  std::optional<OwnFaces> own{};  // none: the surface is a contour
};

// A surface has faults, in spite of all: an error of the program. what() says which (described()).
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

// The surface that separates the `inside` nodes from the others: closed, oriented outward, 2-manifold, without
// self-intersections. All of that has been checked, exactly, on the vertices returned. `inside`: what nodes_inside()
// finds by an evaluator of `mesh` and the rule and, where the set has a thickness, insert_near() adds.
// Vertices lie on the mesh (where the source is a triangle) or where the winding number passes a threshold of the rule
// (kHole). They are off by at most four margins of the longest spacing, or by plane_tolerance() if that is more. The
// margin is surface_margin(); where a surface has faults, 64 times as much, then 4096 times. With `simplify`, no point
// of the surface is farther than that from the surface without it, nor the other way round. A face is in the plane of
// its source, as nearly; one that cuts an edge off has a source near to its middle.
// Uses the threads that ThreadLimit allows; the same for any number of them. Preconditions: !inside.empty(),
// !inside.reaches_border(); `mesh` is welded and its used vertices are finite. Throws SurfaceFailure, LatticeTooFine,
// LatticeOutOfRange, and std::length_error for more than 2^31 - 1 faces.
[[nodiscard]] FinishedSurface closed_surface(const SurfaceInput& input);

// The margin with which a surface is tried first, as a fraction of a voxel.
[[nodiscard]] double surface_margin(const Lattice& lattice, CoordinatePrecision precision);

// An estimate of the bytes that closed_surface() and measure_surface() take at most, beside `inside` and the mesh, for
// a mesh of so many triangles. Peaks of whole processes were 0.8 to 2 times as much. Takes no memory and little time.
// Precondition: !inside.reaches_border().
[[nodiscard]] double surface_bytes(const NodeSet& inside, std::size_t triangles);

}  // namespace raycone
