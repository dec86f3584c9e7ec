// Meshes as they come are turned until their faces agree.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

enum class Orient {
  kKeep,  // faces as they are stored
  kFlip,  // every face reversed
  kAuto,  // consistent, and outward
};

// Whether vertices may be at the same position. Where none are, nobody looks for them.
enum class EqualVertices { kMayBe, kNone };

struct OrientationCounts {
  std::uint64_t flipped_faces = 0;       // of those that are left, how many were stored the other way round
  std::uint64_t dropped_duplicates = 0;  // of the same three positions as a face that is left
  std::uint64_t patches = 0;             // sets of faces that were turned together
  std::uint64_t cut_edges = 0;           // where two faces cannot agree, as on a Moebius strip
  // Edges at which faces end whose copies were stored as often either way, while all other faces close each other: as
  // where a wall between two cells meets their other faces. The winding number is no integer around them.
  std::uint64_t wall_edges = 0;

  OrientationCounts& operator+=(const OrientationCounts& other) {
    flipped_faces += other.flipped_faces;
    dropped_duplicates += other.dropped_duplicates;
    patches += other.patches;
    cut_edges += other.cut_edges;
    wall_edges += other.wall_edges;
    return *this;
  }
};

struct OrientedMesh {
  TriangleMesh mesh;
  OrientationCounts counts;  // all 0 but with kFlip and kAuto
  // The place of each face in the mesh as it was; empty where none was dropped.
  std::vector<std::uint32_t> places = {};
};

// The mesh with its faces turned. Vertices stay as they are, faces in their order and with their first corner. kAuto:
//
//   Of faces with the same three positions, one is left. Those with two equal corners are not turned.
//   Patches are joined across edges that exactly two faces share, and turned to agree; where they cannot, they are cut.
//   A closed patch has no boundary, as a sum of directed edges. Outside all others it is turned outward. Within another
//   one it is turned the other way than the innermost of those around it; if the faces of both agreed as stored, the
//   two keep their relation instead. Open patches are turned so that the winding number comes closest to 0 before the
//   faces and 1 behind them. Closed patches that lie within what open ones enclose are turned as within a closed one.
//
// docs/method.md, "Orientation", has the rules. The result does not depend on the order of faces and vertices, nor on
// the number of threads; it uses those that ThreadLimit allows. Preconditions: the vertices that triangles use are
// finite, and no coordinate is -0 (core/mesh/weld.h). Throws std::bad_alloc, and std::length_error for more than
// kMaxTriangles.
[[nodiscard]] OrientedMesh orient(TriangleMesh mesh, Orient how, EqualVertices equal = EqualVertices::kMayBe);

}  // namespace raycone
