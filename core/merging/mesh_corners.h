// Vertices of a surface that are corners of the mesh, or in its level planes, but for rounding and margins.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Which points of a surface are moved: those next to corners of the mesh to these; and, before that, those of faces in
// level planes into these.
enum class PointMoves : std::uint8_t { kNone, kToCorners, kIntoLevelPlanes };

// Moves vertices of a surface, by `reach` world units in all at most. `sources`: of its faces, triangles of `input`;
// negative: none. `lattice`: of about the size of the faces. `reach` is less than its spacing. The used vertices of
// `input` are finite.
void move_points(PointMoves moves, const TriangleMesh& input, const std::vector<std::int32_t>& sources,
                 const Lattice& lattice, double reach, TriangleMesh& surface);

// Moves vertices to vertices of `input` within `reach`: of those near to one of the input's the nearest, of equally
// near ones the first. Of several of the input's that choose one vertex the nearest has it.
void move_to_corners(const TriangleMesh& input, const Lattice& lattice, double reach, std::vector<Vec3>& vertices);

// Moves corners of faces whose source is level along an axis into its plane, exactly, where they are within `reach` of
// it.
void move_into_level_planes(const TriangleMesh& input, const std::vector<std::int32_t>& sources, double reach,
                            TriangleMesh& surface);

}  // namespace raycone
