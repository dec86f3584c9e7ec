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
  PieceFinder(const Patches& patches, const FaceNeighbours& neighbours) : patches_(patches), neighbours_(neighbours) {
    pieces_.sign.assign(patches.size(), 1);
    for (std::uint32_t patch = 0; patch < patches.size(); ++patch) pieces_.of_patch.push_back(patch);
    pieces_.is_closed.assign(patches.size(), 1);
  }

  Pieces find(const std::vector<std::int8_t>& vote) {
    join_as_stored(vote);
    while (join()) {
    }
    for (const UnpairedEdge& edge : neighbours_.unpaired()) {
      for (const NetUse& use : net_uses(edge)) pieces_.is_closed[use.piece] = 0;
    }
    for_each_cut_patch([this](std::uint32_t patch) { pieces_.is_closed[pieces_.of_patch[patch]] = 0; });
    return std::move(pieces_);
  }

 private:
  // Those that do not cancel.
  [[nodiscard]] std::vector<NetUse> net_uses(const UnpairedEdge& edge) const {
    std::vector<NetUse> uses;
    for (const FaceAtEdge& at : edge.faces) {
      const std::uint32_t patch = patches_.of_face[at.face];
      const std::uint32_t piece = pieces_.of_patch[patch];
      uses.push_back({piece, at.direction * patches_.sign[at.face] * pieces_.sign[patch]});
    }
    // Thousands of pieces may meet at an edge.
    std::ranges::sort(uses, {}, &NetUse::piece);
    std::size_t last = 0;
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (uses[i].piece == uses[last].piece) {
        uses[last].net += uses[i].net;
      } else {
        uses[++last] = uses[i];
      }
    }
    if (!uses.empty()) uses.resize(last + 1);
    std::erase_if(uses, [](const NetUse& use) { return use.net == 0; });
    return uses;
  }

  // How the faces of a patch are stored.
  enum class Stored : std::uint8_t { kWithoutOpinion, kAsPatch, kReversed, kMixed };

  [[nodiscard]] std::vector<Stored> stored_patches(const std::vector<std::int8_t>& vote) const {
    std::vector<Stored> stored(patches_.size());
    for (std::size_t patch = 0; patch < patches_.size(); ++patch) {
      bool as_patch = false, reversed = false, neither = false;
      for (const std::uint32_t face : patches_[patch]) {
        const int sign = vote[face] * patches_.sign[face];
        (sign > 0 ? as_patch : sign < 0 ? reversed : neither) = true;
      }
      stored[patch] = as_patch + reversed + neither > 1 ? Stored::kMixed
                      : as_patch                        ? Stored::kAsPatch
                      : reversed                        ? Stored::kReversed
                                                        : Stored::kWithoutOpinion;
    }
    for_each_cut_patch([&](std::uint32_t patch) { stored[patch] = Stored::kMixed; });
    return stored;
  }

  // Where one edge of a set of patches does not cancel, or one patch is mixed, the file is not to be trusted: none of
  // the set is joined here. Patches without an opinion, as the walls that cells share, neither join nor hinder.
  void join_as_stored(const std::vector<std::int8_t>& vote) {
    const std::vector<Stored> stored = stored_patches(vote);
    const auto sign = [&](std::uint32_t patch) { return stored[patch] == Stored::kReversed ? -1 : 1; };
    std::vector<std::uint8_t> hinders(patches_.size(), 0);
    std::vector<std::vector<PieceLink>> links(patches_.size());
    for (std::uint32_t patch = 0; patch < patches_.size(); ++patch) hinders[patch] = stored[patch] == Stored::kMixed;
    for (const UnpairedEdge& edge : neighbours_.unpaired()) {
      std::vector<NetUse> uses = net_uses(edge);
      std::erase_if(uses, [&](const NetUse& use) { return stored[use.piece] == Stored::kWithoutOpinion; });
      int sum = 0;
      for (std::size_t i = 0; i < uses.size(); ++i) {
        sum += sign(uses[i].piece) * uses[i].net;
        if (i == 0) continue;
        const std::uint32_t a = uses[i - 1].piece, b = uses[i].piece;
        links[a].push_back({b, sign(a) * sign(b)});
        links[b].push_back({a, sign(a) * sign(b)});
      }
      if (sum != 0) hinders[uses.front().piece] = 1;
    }
    join_linked(links, hinders);
  }

  // What becomes one piece, turned so; false where there is nothing to join.
  bool join() {
    std::vector<std::vector<PieceLink>> links(pieces_.size());
    for (const UnpairedEdge& edge : neighbours_.unpaired()) {
      if (edge.faces.size() < 2) continue;
      const std::vector<NetUse> uses = net_uses(edge);
      if (uses.size() != 2 || std::abs(uses[0].net) != std::abs(uses[1].net)) continue;
      const int relation = uses[0].net == uses[1].net ? -1 : 1;
      links[uses[0].piece].push_back({uses[1].piece, relation});
      links[uses[1].piece].push_back({uses[0].piece, relation});
    }
    return join_linked(links, std::vector<std::uint8_t>(pieces_.size(), 0));
  }

  // False where there is nothing to join: links that contradict each other, or lead to a piece that hinders, do not.
  bool join_linked(const std::vector<std::vector<PieceLink>>& links, const std::vector<std::uint8_t>& hinders) {
    std::vector<std::uint32_t> joined(pieces_.size());
    std::vector<int> sign(pieces_.size(), 0);
    std::uint32_t count = 0;
    for (std::uint32_t start = 0; start < pieces_.size(); ++start) {
      if (sign[start] != 0) continue;
      const std::vector<std::uint32_t> linked = spread(start, links, sign);
      const bool consistent = std::all_of(linked.begin(), linked.end(), [&](std::uint32_t piece) {
        return hinders[piece] == 0 && std::all_of(links[piece].begin(), links[piece].end(), [&](const PieceLink& link) {
                 return sign[piece] * sign[link.to] == link.relation;
               });
      });
      for (const std::uint32_t piece : linked) {
        joined[piece] = consistent ? count : count++;
        if (!consistent) sign[piece] = 1;
      }
      count += consistent;
    }
    if (count == pieces_.size()) return false;
    for (std::size_t patch = 0; patch < patches_.size(); ++patch) {
      const std::uint32_t piece = pieces_.of_patch[patch];
      pieces_.sign[patch] = static_cast<std::int8_t>(pieces_.sign[patch] * sign[piece]);
      pieces_.of_patch[patch] = joined[piece];
    }
    pieces_.is_closed.assign(count, 1);
    return true;
  }

  static std::vector<std::uint32_t> spread(std::uint32_t start, const std::vector<std::vector<PieceLink>>& links,
                                           std::vector<int>& sign) {
    std::vector<std::uint32_t> reached{start};
    sign[start] = 1;
    for (std::size_t next = 0; next < reached.size(); ++next) {
      for (const PieceLink& link : links[reached[next]]) {
        if (sign[link.to] != 0) continue;
        sign[link.to] = sign[reached[next]] * link.relation;
        reached.push_back(link.to);
      }
    }
    return reached;
  }

  // Some patches may come more than once.
  template <class Visit>
  void for_each_cut_patch(const Visit& visit) const {
    if (patches_.cut_edges == 0) return;
    for (std::uint32_t face = 0; face < patches_.of_face.size(); ++face) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const FaceNeighbour other = neighbours_.neighbour(face, corner);
        if (other.agrees == 0 || patches_.sign[face] * patches_.sign[other.face] == other.agrees) continue;
        visit(patches_.of_face[face]);
      }
    }
  }

  const Patches& patches_;
  const FaceNeighbours& neighbours_;
  Pieces pieces_;
};

}  // namespace

Pieces find_pieces(const Patches& patches, const FaceNeighbours& neighbours, const std::vector<std::int8_t>& vote) {
  return PieceFinder(patches, neighbours).find(vote);
}

}  // namespace raycone
