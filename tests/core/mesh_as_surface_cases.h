// Meshes that may be surfaces themselves, and what tests ask of these surfaces.
#pragma once

#include <optional>
#include <vector>

#include "core/cells/node_set.h"
#include "core/data/lattice.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"
#include "core/surface/surface.h"

namespace raycone::test {

// By angles that make no coordinates agree.
TriangleMesh turned(TriangleMesh mesh);

// About `side` samples along the longest side, half a voxel from the box of the mesh, and a layer around.
Lattice lattice_around(const TriangleMesh& mesh, double side);
NodeSet nodes_of(const TriangleMesh& mesh, double side, const Rule& rule = {});

// mesh_as_surface() on that lattice; expects of it what any surface must be.
std::optional<FinishedSurface> kept(const TriangleMesh& mesh, double side, const SurfaceOptions& options = {});

// Whether all triangles of the mesh are part of the surface, as is known.
bool holds_all(const FinishedSurface& made);

std::vector<Vec3> sorted_vertices(const TriangleMesh& mesh);

// A cube of that size, with its lowest corner at (x, 0.3, 0.4).
TriangleMesh box_at(double x, double size);

// A block of 1 by 1 by 1, with a fin of this thickness and length.
TriangleMesh finned(double thickness, double length);

}  // namespace raycone::test
