// Which triangle of the mesh each face of a surface is of.
#pragma once

#include "core/data/triangle_mesh.h"
#include "core/surface/contour.h"

namespace raycone {

// Gives faces another source whose own cannot be theirs: that are more than 15 degrees or `off`, a length, from its
// plane. They get the triangle that is nearest to their middle, of several the first; or none, if that one cannot be
// theirs either and a face without a source is beside them, in line with them. A face has the source of one of
// its corners at first; where a lattice edge meets the mesh on an edge, that may be the triangle on the other side.
// Faces without a source keep none. The same for any number of threads. Precondition: sources are triangles of `input`,
// or kHole.
void settle_sources(const TriangleMesh& input, double off, SurfaceMesh& surface);

}  // namespace raycone
