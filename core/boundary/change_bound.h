// How fast winding numbers can change from place to place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/caps.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The winding number of a mesh jumps by integers where its surface is. Beside that it changes as the solid angles of
// its loops do. By the law of Biot and Savart a piece of an edge, of length L, adds at most L / (4 pi d^2) to the
// length of the gradient at a distance d. A loop with caps of area A adds at most the integral of the gradients of
// dipoles, 2 A / (4 pi d^3), d being the distance from the caps: less, if it is narrow. Second derivatives, along any
// direction, are at most 2 L / (4 pi d^3) and 6 A / (4 pi d^4), third ones 6 L / (4 pi d^4) and 24 A / (4 pi d^5). A
// tree gathers all. Thread-safe.
class ChangeBound {
 public:
  // Of a mesh in scale: coordinates of at most 1, lest squares overflow.
  explicit ChangeBound(const Caps& caps);

  struct Bounds {
    double gradient;  // its length is at most this, turns per unit
    double second;    // and second derivatives this, turns per square unit
    double third;     // and third ones
  };
  // In the closed box. Infinite where the box comes too close, or where that of the gradient exceeds `limit`, beyond
  // which they are of no use.
  [[nodiscard]] Bounds in(const Box& box, double limit) const;

  // Boxes that contain the caps of wide loops, which are cut into pieces.
  [[nodiscard]] std::span<const Box> wide_caps() const { return wide_caps_; }

 private:
  struct Source {
    Box box;
    double length, area;  // L and 2 A, over 4 pi
  };
  // Sources [begin, end). The clusters that it is made of follow it, up to `next`.
  struct Cluster {
    Source sum;
    std::uint32_t begin, end, next;
  };
  void add_edges(const std::vector<DirectedEdge>& edges);
  void add_narrow(const Caps& caps);
  void add_wide(const Caps& caps);
  void cut(const Vec3& a, const Vec3& b, const Vec3& c, int depth);
  void build(std::uint32_t begin, std::uint32_t end);

  double piece_ = 0, place_error_ = 0;  // length of pieces, and how far they may be from where they are, at most
  std::vector<Source> sources_;
  std::vector<Cluster> clusters_;
  std::vector<Box> wide_caps_;
};

}  // namespace raycone
