// How far what is in one plane may be off it.
#pragma once

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// How far apart numbers of one plane may be, world units: a billionth of a voxel, or what the coordinates' own format
// rounds. That is 2^-22 of the largest one where all of them are numbers in single precision, and 2^-20 where the
// others have nine digits at most, as numbers in text files; a thousandth of a voxel at most, far from the origin.
[[nodiscard]] double plane_tolerance(const TriangleMesh& mesh, const Lattice& lattice);

// How far numbers in double precision may be off a plane, whatever the mesh's format rounds: a billionth of a voxel, or
// 2^-50 of the largest coordinate of the lattice.
[[nodiscard]] double fine_tolerance(const Lattice& lattice);

}  // namespace raycone
