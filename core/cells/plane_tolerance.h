// How far what is in one plane may be off it.
#pragma once

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// How far apart points of one plane may be, world units: a billionth of a voxel or, if that is more, what the format of
// the mesh's coordinates rounds; but a thousandth of a voxel at most. The format rounds 2^-22 of the largest coordinate
// where all are numbers in single precision; 2^-20 where the others have nine digits at most, as in text files; else
// 2^-50.
[[nodiscard]] double plane_tolerance(const TriangleMesh& mesh, const Lattice& lattice);

// The same for numbers in double precision, whatever the mesh's format rounds: the larger one of a billionth of a voxel
// and 2^-50 of the largest coordinate of the lattice.
[[nodiscard]] double fine_tolerance(const Lattice& lattice);

}  // namespace raycone
