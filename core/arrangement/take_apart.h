// Solids that touch along edges or at vertices, taken apart there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/coordinate_precision.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

struct ApartOptions {
  double distance = 0.0;                                         // by which vertices move, world units
  CoordinatePrecision precision = CoordinatePrecision::kDouble;  // of new vertices
  // Whether vertices move against the perturbation where they can: along one axis where that is enough, else by far
  // less along y than along x, and along z than along y; each next fan of a vertex farther. Points on the faces there
  // are then on the side of all of them where the perturbation has them.
  bool against_perturbation = false;
  // Whether vertices that cannot move as above are moved another way. The ways are: into the inside, or against the
  // perturbation, whichever the others go; the other one of the two; then both again, four times as far.
  bool other_ways = false;
  // Per vertex, how many of the ways that it has left faults there before: so many are skipped. Vertices that halve
  // edges count after those of the border. 0 for vertices beyond the end.
  std::vector<std::uint8_t> in_vain{};
};

// Makes a 2-manifold of the border of a solid. Where the border touches itself at a vertex or along an edge, each part
// of the solid gets a vertex of its own. One part keeps the old vertex. The vertices of the others move into the parts'
// insides by the distance, or out of them where that leads away from the rest, or against the perturbation. Where no
// way leads into a part or out of it, its corner is cut off, by 2^-12 of each edge. Faces at an edge belong together
// where the solid is between them. An edge that two parts would still share, with both its ends, is halved.
// `sources`: of each triangle; those of new triangles are added. Returns of each vertex the one that it is a copy of,
// or itself. Whether what has moved meets anything is for the caller to check.
// Returns nothing, and leaves the border half done, where faces do not say on which side the solid is (face_pairs()),
// where two parts at a vertex can neither be moved nor be cut off, and where more than 64 parts meet at a vertex or
// more than 256 corners would be cut off. Precondition: every edge has as many faces in either direction. Needs
// DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> take_apart(TriangleMesh& border,
                                                                   std::vector<std::uint32_t>& sources,
                                                                   const ApartOptions& options);

}  // namespace raycone
