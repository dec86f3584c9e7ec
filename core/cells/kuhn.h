// The Kuhn subdivision of the cells of a lattice: each cell is cut into six tetrahedra around one of its diagonals, so
// that neighbouring cells agree about the faces between them (Kuhn 1960; Freudenthal 1942).
//
// Bit a of a corner's number is set at the upper end of axis a. A corner is below another one where its bits are a
// part of the other's. Edges join corners of which one is below the other; faces and tetrahedra are chains of three
// and of four.
#pragma once

#include <array>
#include <cstddef>

namespace raycone::kuhn {

inline constexpr unsigned kCorners = 8;

// Edges and faces belong to the cell of their lowest node. `direction` is the other end of an edge seen from there, as
// a corner, 1 to 7; a face has two of them, the first below the second.
struct FaceDirections {
  unsigned first, second;
};
inline constexpr std::array<FaceDirections, 12> kFaces{
    {{1, 3}, {2, 3}, {1, 5}, {4, 5}, {2, 6}, {4, 6}, {1, 7}, {2, 7}, {4, 7}, {3, 7}, {5, 7}, {6, 7}}};

// The first of kFaces are halves of the squares between two cells, the others are within one.
inline constexpr std::size_t kFacesBetweenCells = 6;

// The place of a face in kFaces.
constexpr std::size_t face_number(unsigned first, unsigned second) {
  for (std::size_t i = 0; i < kFaces.size(); ++i) {
    if (kFaces[i].first == first && kFaces[i].second == second) return i;
  }
  return kFaces.size();
}

// The corners of a tetrahedron by rank, and whether the volume spanned by the edges from the first one is positive.
struct Tetrahedron {
  std::array<unsigned, 4> corners;
  bool positive;
};
inline constexpr std::array<Tetrahedron, 6> kTetrahedra{{{{0, 1, 3, 7}, true},
                                                         {{0, 2, 6, 7}, true},
                                                         {{0, 4, 5, 7}, true},
                                                         {{0, 2, 3, 7}, false},
                                                         {{0, 1, 5, 7}, false},
                                                         {{0, 4, 6, 7}, false}}};

}  // namespace raycone::kuhn
