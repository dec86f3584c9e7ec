// The boundary of a mesh: its exterior edges, and what they say for certain about a winding number.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/chain.h"
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

  // `w`, a winding number of the mesh at q that is off by at most kMostDoubt, on the side of `critical` on which the
  // true one is; `critical` itself where that cannot be told. Takes as long as thousands of winding numbers, but no
  // longer than two where the answer is a half-integer because all exterior edges lie in one plane with q. Needs
  // DefaultFloatingPoint. Thread-safe.
  [[nodiscard]] double settle(const Vec3& q, double w, double critical) const;
  static constexpr double kMostDoubt = 0.125;  // turns

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
