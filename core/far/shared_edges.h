// The boundary of sets of triangles, which may be cheaper to sum than the triangles themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/boundary/chain.h"
#include "core/boundary/solid_angle_kernel.h"

namespace raycone {

// Which of some triangles share edges. Thread-safe once made.
class SharedEdges {
  // What finding a boundary takes for each edge and vertex. Between two sets it is as it was at first.
  struct Scratch {
    std::vector<std::int32_t> multiplicities;  // of edges: 0
    std::vector<std::uint32_t> leaving;        // an edge of the boundary, by the vertex that it leaves: kNone
  };

 public:
  static constexpr std::size_t kMostTriangles = (std::size_t{1} << 30) - 1;

  // Of kMostTriangles at most; throws std::length_error. Does not depend on their addresses.
  explicit SharedEdges(std::span<const SolidTriangle> triangles);

  // Finds the boundaries of sets, one after the other. For one thread.
  class Boundary {
   public:
    // `edges` must outlive this. Takes memory for each of its edges, which the next one uses again.
    explicit Boundary(const SharedEdges& edges) : all_(edges), scratch_(edges.take_scratch()) {}
    ~Boundary() {
      if (!is_at_work_) all_.give_back(std::move(scratch_));
    }
    Boundary(const Boundary&) = delete;
    Boundary& operator=(const Boundary&) = delete;

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
    Scratch scratch_;
    bool is_at_work_ = false;             // or was, when an exception came
    std::vector<std::uint32_t> touched_;  // edges of the triangles, some of them several times
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

  [[nodiscard]] Scratch take_scratch() const;
  void give_back(Scratch scratch) const noexcept;

  std::vector<Vec3> vertices_;
  std::vector<Edge> edges_;
  std::vector<Side> sides_;  // three of each triangle; kNone: along the rays
  mutable std::mutex mutex_;
  mutable std::vector<Scratch> spare_;  // of boundaries that are gone
};

}  // namespace raycone
