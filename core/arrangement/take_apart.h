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
  // Vertices move against the perturbation where they can: along one axis where that is enough, else by far less along
  // y than along x, and along z than along y; those of several fans farther and farther. What lies on faces there is
  // then on the side of all of them that it is on as perturbed.
  bool against_perturbation = false;
  // Whether vertices that cannot go this way go another one: first into insides, or against the perturbation, as the
  // others go; then the other one of the two; then both again, four times as far.
  bool other_ways = false;
  // Of each vertex how many of these left faults there before, also of those that halve edges; none of those beyond the
  // end. The next way that there is is taken.
  std::vector<std::uint8_t> in_vain{};
};

// Makes a 2-manifold of the border of a solid: where it touches itself in a vertex or along an edge, each part of the
// solid gets a vertex of its own, which all of them but one have moved into their insides by the distance, or out of
// them where that is the way to go, or against the perturbation. Where there is no way into a part, its corner is cut
// off, by 2^-12 of each edge. Faces along an edge belong together where the solid is between them. An edge along which
// that leaves two parts the same two ends is halved. `sources`: of each triangle, and so of its halves. Returns of each
// vertex the one that it is a part's own copy of, or itself. Nothing, and the border is left half done, where it has no
// two sides, as where of more than two faces at an edge one lies on another, or no way is left at a vertex: two parts
// cannot be moved, nor be cut off. Whether what is moved meets nothing must be looked at after it. Precondition: every
// edge has as many faces in either direction. Needs DefaultFloatingPoint.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> take_apart(TriangleMesh& border,
                                                                   std::vector<std::uint32_t>& sources,
                                                                   const ApartOptions& options);

}  // namespace raycone
