// The boundary of sets of triangles, which may be cheaper to sum than the triangles themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/chain.h"
#include "core/boundary/solid_angle_kernel.h"

namespace raycone {

// Which of some triangles share edges. Thread-safe once made.
class SharedEdges {
 public:
  // Throws std::length_error from 2^30 triangles on. Does not depend on their addresses.
  explicit SharedEdges(std::span<const SolidTriangle> triangles);

  // Finds the boundaries of sets, one after the other.
  class Boundary {
   public:
    // `edges` must outlive this. Takes memory for each of its edges.
    explicit Boundary(const SharedEdges& edges);

    // Of the triangles with these numbers, each of them once: edges that do not cancel, as often as they are left, but
    // for those along the rays, whose factor is 1 from everywhere. Valid until the next call. Nothing where it has more
    // than `most` edges.
    [[nodiscard]] std::optional<std::span<const ChainStep>> of(std::span<const std::uint32_t> triangles,
                                                               std::size_t most);

   private:
    // How many edges are left, each as often as that.
    std::size_t set_multiplicities(std::span<const std::uint32_t> triangles);
    void set_chains();
    void add_chain(std::uint32_t edge);

    const SharedEdges& all_;
    std::vector<std::int32_t> multiplicities_;  // of edges
    std::vector<std::uint32_t> leaving_;        // an edge of the boundary, by the vertex that it leaves
    std::vector<std::uint32_t> touched_;        // edges of the triangles, some of them several times
    std::vector<ChainStep> steps_;
  };

 private:
  struct Edge {
    std::uint32_t from, to;  // vertices
  };
  // An edge of a triangle: its number, and whether the triangle runs along it the other way.
  struct Side {
    std::uint32_t edge;
    bool reversed;
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  std::vector<Vec3> vertices_;
  std::vector<Edge> edges_;
  std::vector<Side> sides_;  // three of each triangle; kNone: along the rays
};

}  // namespace raycone
