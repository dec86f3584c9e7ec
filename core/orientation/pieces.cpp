#include "core/orientation/pieces.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace raycone {
namespace {

// How often the faces of a piece run along an edge, from its lower vertex to the higher one less the other way.
struct NetUse {
  std::uint32_t piece;
  int net;
};

// Two pieces that close each other at some edge if `relation` is the product of their turns.
struct PieceLink {
  std::uint32_t to;
  int relation;
};

class PieceFinder {
 public:
  PieceFinder(const Patches& patches, const FaceEdges& edges) : patches_(patches), edges_(edges) {
    pieces_.sign.assign(patches.size(), 1);
    for (std::uint32_t patch = 0; patch < patches.size(); ++patch) pieces_.of_patch.push_back(patch);
    pieces_.is_closed.assign(patches.size(), 1);
  }

  Pieces find() {
    while (join()) {
    }
    for (const UnpairedEdge& edge : edges_.unpaired()) {
      for (const NetUse& use : net_uses(edge)) pieces_.is_closed[use.piece] = 0;
    }
    open_cut_patches();
    return std::move(pieces_);
  }

 private:
  // Those that do not cancel.
  [[nodiscard]] std::vector<NetUse> net_uses(const UnpairedEdge& edge) const {
    std::vector<NetUse> uses;
    for (const FaceAtEdge& at : edge.faces) {
      const std::uint32_t patch = patches_.of_face[at.face];
      const std::uint32_t piece = pieces_.of_patch[patch];
      const int direction = at.direction * patches_.sign[at.face] * pieces_.sign[patch];
      const auto it = std::find_if(uses.begin(), uses.end(), [&](const NetUse& use) { return use.piece == piece; });
      if (it == uses.end()) {
        uses.push_back({piece, direction});
      } else {
        it->net += direction;
      }
    }
    std::erase_if(uses, [](const NetUse& use) { return use.net == 0; });
    return uses;
  }

  // What becomes one piece, turned so; false where there is nothing to join.
  bool join() {
    std::vector<std::vector<PieceLink>> links(pieces_.size());
    for (const UnpairedEdge& edge : edges_.unpaired()) {
      if (edge.faces.size() < 2) continue;
      const std::vector<NetUse> uses = net_uses(edge);
      if (uses.size() != 2 || std::abs(uses[0].net) != std::abs(uses[1].net)) continue;
      const int relation = uses[0].net == uses[1].net ? -1 : 1;
      links[uses[0].piece].push_back({uses[1].piece, relation});
      links[uses[1].piece].push_back({uses[0].piece, relation});
    }
    std::vector<std::uint32_t> joined(pieces_.size());
    std::vector<int> turn(pieces_.size(), 0);
    std::uint32_t count = 0;
    for (std::uint32_t start = 0; start < pieces_.size(); ++start) {
      if (turn[start] != 0) continue;
      const std::vector<std::uint32_t> linked = spread(start, links, turn);
      const bool consistent = std::all_of(linked.begin(), linked.end(), [&](std::uint32_t piece) {
        return std::all_of(links[piece].begin(), links[piece].end(),
                           [&](const PieceLink& link) { return turn[piece] * turn[link.to] == link.relation; });
      });
      for (const std::uint32_t piece : linked) {
        joined[piece] = consistent ? count : count++;
        if (!consistent) turn[piece] = 1;
      }
      count += consistent;
    }
    if (count == pieces_.size()) return false;
    for (std::size_t patch = 0; patch < patches_.size(); ++patch) {
      const std::uint32_t piece = pieces_.of_patch[patch];
      pieces_.sign[patch] = static_cast<std::int8_t>(pieces_.sign[patch] * turn[piece]);
      pieces_.of_patch[patch] = joined[piece];
    }
    pieces_.is_closed.assign(count, 1);
    return true;
  }

  static std::vector<std::uint32_t> spread(std::uint32_t start, const std::vector<std::vector<PieceLink>>& links,
                                           std::vector<int>& turn) {
    std::vector<std::uint32_t> reached{start};
    turn[start] = 1;
    for (std::size_t next = 0; next < reached.size(); ++next) {
      for (const PieceLink& link : links[reached[next]]) {
        if (turn[link.to] != 0) continue;
        turn[link.to] = turn[reached[next]] * link.relation;
        reached.push_back(link.to);
      }
    }
    return reached;
  }

  void open_cut_patches() {
    if (patches_.cut_edges == 0) return;
    for (std::uint32_t face = 0; face < patches_.of_face.size(); ++face) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const FaceNeighbour other = edges_.neighbour(face, corner);
        if (other.agrees == 0 || patches_.sign[face] * patches_.sign[other.face] == other.agrees) continue;
        pieces_.is_closed[pieces_.of_patch[patches_.of_face[face]]] = 0;
      }
    }
  }

  const Patches& patches_;
  const FaceEdges& edges_;
  Pieces pieces_;
};

}  // namespace

Pieces find_pieces(const Patches& patches, const FaceEdges& edges) { return PieceFinder(patches, edges).find(); }

}  // namespace raycone
