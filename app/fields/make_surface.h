// The closed surface of a mesh, with what its user is told of it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "app/report/run_report.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/data/warning.h"
#include "core/evaluation/winding_number.h"
#include "core/mesh/exterior_edges.h"
#include "core/orientation/orient.h"
#include "core/surface/surface.h"

namespace raycone {

struct MadeSurface {
  SurfaceMesh surface;
  SurfaceReport report;
  std::vector<Warning> warnings;  // `not-merged`, `not-simplified`, `thin-parts`: those that apply
  Tally tally;                    // of the nodes of the lattice
  Terms terms;                    // that were summed for them and for the surface
};

// What the surface is of, and what the user has chosen, so that errors advise something else.
struct MeshToClose {
  const TriangleMesh& mesh;
  const std::vector<ExteriorEdge>& edges;  // of `mesh`
  std::string name;                        // of its file
  Orient orient = Orient::kKeep;
  bool like_grid = false;  // the lattice is that of --like
};

// The surface between the inside and the outside nodes of `lattice`, by winding numbers of the mesh; it has been
// checked. `done`, where given, grows by one per node. Throws InputError (nothing is inside, or the inside reaches the
// lattice's border), LimitError (`memory`, bytes, does not do for the nodes or, as soon as these are known, for the
// surface; or numbers do not do for it), SurfaceFailure.
[[nodiscard]] MadeSurface make_surface(const MeshToClose& input, const Lattice& lattice, const SurfaceOptions& options,
                                       std::uint64_t memory, std::atomic<std::uint64_t>* done = nullptr);

}  // namespace raycone
