// The boundary of a mesh: its exterior edges, and what they say for certain about a winding number.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/chain.h"
#include "core/boundary/sample_tile.h"
#include "core/data/triangle_mesh.h"
#include "core/mesh/exterior_edges.h"

namespace raycone {

// An exterior edge, turned so that its multiplicity is positive.
struct DirectedEdge {
  Vec3 from, to;
  std::int32_t multiplicity;  // positive
};

// Const calls are thread-safe.
class Boundary {
 public:
  // Of a welded mesh with these exterior_edges(). Needs DefaultFloatingPoint.
  Boundary(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges);
  explicit Boundary(const TriangleMesh& mesh) : Boundary(mesh, raycone::exterior_edges(mesh)) {}

  // Number of undirected edges; 0: the mesh is closed.
  [[nodiscard]] std::uint64_t exterior_edges() const { return edges_; }

  // Whether there is just one plane in which all exterior edges lie: not where they are on a line.
  [[nodiscard]] bool is_flat() const { return plane_.has_value(); }

  // The sum of |multiplicities|. What w is off by is bounded in proportion to it: doubt_of_factors().
  [[nodiscard]] double total_multiplicity() const { return total_multiplicity_; }

  // All edges but those along the rays, whose factor is 1 from everywhere.
  [[nodiscard]] std::span<const ChainGroup> groups() const { return groups_; }

  // All edges, as ExteriorEdge says, with positive multiplicities.
  [[nodiscard]] std::vector<DirectedEdge> directed_edges() const;

  static constexpr double kMostDoubt = 0.125;  // of a value that settle() takes, turns

  // Which sample of a tile, and a number that its winding number may be on the wrong side of.
  struct ToSettle {
    std::size_t sample;
    double critical;
  };
  // Moves w[sample], a winding number of the mesh there that is off by at most kMostDoubt, to the side of `critical` on
  // which the true one is; to `critical` itself where that cannot be told. Takes some thirty times as long as winding
  // numbers do, now and then a thousand times, but no longer than two where the answer is a half-integer because all
  // exterior edges lie in one plane with a sample. Needs DefaultFloatingPoint. Thread-safe.
  void settle(const SampleTile& samples, std::span<const ToSettle> doubtful, std::span<double> w) const;

  // How far winding numbers of the mesh are off at most, turns: w[i] at sample i, whose ray has n = crossings[i]. That
  // is |w - w2| and the bound of w2, which the cone in extended precision gives, whatever w comes from. Needs
  // DefaultFloatingPoint. Thread-safe.
  void bound_errors(SampleTile& samples, std::span<const double> w, std::span<const std::int64_t> crossings,
                    std::span<double> bounds) const;

 private:
  void add_chains(const TriangleMesh& mesh, const std::vector<ExteriorEdge>& edges);
  void find_plane();
  [[nodiscard]] bool lies_in_plane_of_edges(const Vec3& q) const;

  std::uint64_t edges_ = 0;
  double total_multiplicity_ = 0.0;
  std::vector<ChainGroup> groups_;
  std::vector<DirectedEdge> edges_along_rays_;
  std::optional<std::array<Vec3, 3>> plane_;  // through all edges, where there is just one
};

}  // namespace raycone
