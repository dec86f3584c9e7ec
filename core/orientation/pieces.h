// Patches that close each other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/orientation/face_neighbours.h"
#include "core/orientation/patches.h"

namespace raycone {

// Patches are joined to a piece where they close each other as they are stored; else at edges where all faces cancel
// but those of two patches, as where two solids touch.
struct Pieces {
  std::vector<std::uint32_t> of_patch;
  std::vector<std::int8_t> sign;        // per patch: how it is turned within its piece
  std::vector<std::uint8_t> is_closed;  // per piece: its boundary, as a sum of directed edges, is 0

  [[nodiscard]] std::size_t size() const { return is_closed.size(); }
};

// `vote`: per face, how it is stored (core/orientation/unique_faces.h). Patches whose faces all agree as stored, and
// that have no boundary together as they are stored, keep their relations to each other. Faces that are stored as often
// either way do not count in this. All others are joined so that their faces cancel at edges; where two edges ask for
// different relations, they are not joined. The result does not depend on the order of faces, but for the numbers of
// pieces and for which of the two orientations is 1. Each round in which patches are joined takes the time of a look at
// all edges. Few rounds do, but for chains of patches of which each decides about the next.
[[nodiscard]] Pieces find_pieces(const Patches& patches, const FaceNeighbours& neighbours,
                                 const std::vector<std::int8_t>& vote);

}  // namespace raycone
