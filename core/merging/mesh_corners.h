// Vertices of a surface that are corners of the mesh, or in its level planes, but for rounding and margins.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Which points of a surface are moved: those next to corners of the mesh, into these; or, before that, those of faces
// in level planes, into the planes.
enum class PointMoves : std::uint8_t { kNone, kToCorners, kIntoLevelPlanes };

// Moves vertices of a surface by `reach` (world units) at most, all moves together. `sources`: of its faces, triangles
// of `input`, or negative: none. `lattice`: of about the size of the faces, its spacing above `reach`. Precondition:
// the used vertices of `input` are finite.
void move_points(PointMoves moves, const TriangleMesh& input, const std::vector<std::int32_t>& sources,
                 const Lattice& lattice, double reach, TriangleMesh& surface);

// Moves vertices into vertices of `input` within `reach`. Each vertex of `input` takes the nearest vertex, of equally
// near ones the first; a vertex that several would take goes to the nearest of them.
void move_to_corners(const TriangleMesh& input, const Lattice& lattice, double reach, std::vector<Vec3>& vertices);

// Where the source of a face is level (equal coordinates along an axis), moves the face's corners into its plane,
// exactly, if they are within `reach` of it.
void move_into_level_planes(const TriangleMesh& input, const std::vector<std::int32_t>& sources, double reach,
                            TriangleMesh& surface);

}  // namespace raycone
