// How fast winding numbers can change from place to place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/caps.h"
#include "core/boundary/change_kernel.h"
#include "core/boundary/flat_piece.h"
#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {

// The winding number of a mesh jumps by integers where its surface is. Beside that it changes as the solid angles of
// its loops do. By the law of Biot and Savart a piece of an edge, of length L, adds at most L / (4 pi d^2) to the
// length of the gradient at a distance d. A loop with caps of area A adds at most the integral of the gradients of
// dipoles, 2 A / (4 pi d^3), d being the distance from the caps: less, if it is narrow. Derivatives of order k, along
// any direction, are at most k! L / (4 pi d^(k+1)) and (k+1)! A / (4 pi d^(k+2)). A tree gathers all; from afar, pieces
// that lead there and back cancel but for how far they are apart. Thread-safe.
class ChangeBound {
 public:
  // Of a mesh in scale: coordinates of at most 1, lest squares overflow. Uses the threads that ThreadLimit allows.
  // Throws std::length_error for more than 2^32 - 1 pieces of edges and caps.
  explicit ChangeBound(const Caps& caps, SimdLevel level = SimdLevel::kBest);

  // The length of the gradient in the closed box is at most this, turns per unit. Infinite where the box comes too
  // close, or where it exceeds `limit`, beyond which it is of no use.
  [[nodiscard]] double gradient_in(const Box& box, double limit) const;

  // [k - 1]: what derivatives of order k along any direction, divided by k!, are at most in the closed box, turns per
  // unit^k. Infinite where the box comes too close.
  [[nodiscard]] ChangeSums derivatives_in(const Box& box) const;

  // The caps of wide loops, cut into pieces.
  [[nodiscard]] std::span<const FlatPiece> wide_caps() const { return wide_caps_; }

 private:
  struct Source {
    Box box;
    double length, area;  // L and 2 A, over 4 pi
    Vec3 along;           // the sum of the pieces from end to end, over 4 pi
  };
  void add_edges(const std::vector<DirectedEdge>& edges);
  void add_narrow(const Caps& caps);
  void add_wide(const Caps& caps);
  static Source seen_from_afar(const Source& cluster);
  static void sort_by_halves(std::span<Source> sources);
  static void halve(std::span<const Source> sources, int times, std::vector<std::span<const Source>>& parts);
  void build(std::uint32_t node, const std::vector<std::span<const Source>>& parts);

  double piece_ = 0, place_error_ = 0;  // length of pieces, and how far they may be from where they are, at most
  std::vector<Source> sources_;
  std::vector<ChangeNode> nodes_;
  ChangeKernel kernel_;
  std::vector<FlatPiece> wide_caps_;
};

}  // namespace raycone
