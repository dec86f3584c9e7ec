// Sets of faces that are turned together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/orientation/face_neighbours.h"

namespace raycone {

struct Patches {
  std::vector<std::uint32_t> of_face;  // patches are counted from 0 by their first faces
  std::vector<std::int8_t> sign;  // per face: 1 where it agrees with its patch as given, -1 where it has to be reversed
  std::vector<std::uint32_t> faces;  // those of one patch after the other
  std::vector<std::size_t> begin;    // where the faces of each patch begin in `faces`; one more at the end
  std::uint64_t cut_edges = 0;       // edges of two faces that do not agree as turned

  [[nodiscard]] std::size_t size() const { return begin.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t patch) const {
    return std::span(faces).subspan(begin[patch], begin[patch + 1] - begin[patch]);
  }
};

// Faces joined across the edges that exactly two of them share, and turned to agree there. Where that is impossible,
// edges are cut: few, though not always the fewest; which ones depends on coordinates only. Takes time in proportion to
// the faces, and n log n for n faces of patches that are cut.
[[nodiscard]] Patches find_patches(const std::vector<Triangle>& faces, const FaceNeighbours& neighbours,
                                   const std::vector<Vec3>& vertices);

}  // namespace raycone
