// Which faces meet at which edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// A face at an edge.
struct FaceAtEdge {
  std::uint32_t face = 0;
  int direction = 1;  // 1: it runs along the edge from the lower vertex to the higher one; -1: the other way
};

// An edge of one face, or of three and more.
struct UnpairedEdge {
  std::uint32_t low = 0, high = 0;
  std::vector<FaceAtEdge> faces;
};

// The other one of exactly two faces at an edge.
struct FaceNeighbour {
  std::uint32_t face = 0;
  int agrees = 0;  // 1: the two run along the edge in opposite directions; -1: in the same one; 0: there is no other
};

// The edges of faces with three different corners each, of which none is there twice.
class FaceNeighbours {
 public:
  // Takes time in proportion to the faces. Uses the threads that ThreadLimit allows.
  FaceNeighbours(const std::vector<Triangle>& faces, std::size_t vertices);

  // Across the edge from `corner` (0 to 2) of the face to its next one.
  [[nodiscard]] FaceNeighbour neighbour(std::uint32_t face, std::size_t corner) const {
    const std::uint32_t bits = neighbours_[face][corner];
    return bits == kNone ? FaceNeighbour{} : FaceNeighbour{bits >> 1, (bits & 1) != 0 ? -1 : 1};
  }

  // By lower vertex, then higher one.
  [[nodiscard]] const std::vector<UnpairedEdge>& unpaired() const { return unpaired_; }

 private:
  struct FiledEdge;

  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::vector<std::array<std::uint32_t, 3>> neighbours_;  // the face, and below it a bit: they do not agree
  std::vector<UnpairedEdge> unpaired_;
};

}  // namespace raycone
