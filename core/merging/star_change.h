// What happens to the faces around a vertex when it is pulled into one of its neighbours.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Faces before and after are compared along one direction: all of them are seen from their fronts, and the vertex's
// neighbours go around it once. Both sets of faces are then graphs over one polygon, and their difference is linear
// between the crossings of their edges.
class StarChange {
 public:
  // `ring`: the neighbours in the order of the faces around `vertex`.
  StarChange(const Vec3& vertex, const std::vector<Vec3>& ring);

  // Pulls the vertex into the neighbour of this number in `ring`. All that follows is about the last such call.
  void pull_into(std::size_t target);

  // A bound of how far points of the faces after are from those before, and the other way round, world units. None
  // where it is not below `most`, or where there is no such direction.
  [[nodiscard]] std::optional<double> distance(double most) const;

  // Whether a node of the lattice is, or may be, between the faces before and after. Precondition: distance() is
  // `distance`.
  [[nodiscard]] bool passes_node(const Lattice& lattice, double distance) const;

 private:
  // By two coordinates across the direction and the height along it.
  [[nodiscard]] Vec3 seen(const Vec3& p) const;
  [[nodiscard]] bool is_graph() const;
  [[nodiscard]] double rounding() const;
  [[nodiscard]] bool is_between(const Vec3& node) const;
  [[nodiscard]] bool passes_node_below_vertex(const Lattice& lattice) const;
  [[nodiscard]] Box box() const;

  Vec3 vertex_;
  std::vector<Vec3> ring_;
  std::array<Vec3, 3> axes_;  // the direction is the last
  Vec3 seen_vertex_;
  std::vector<Vec3> seen_ring_;
  double size_ = 0.0;  // no coordinate of the seen ring is larger
  std::size_t target_ = 0;
  std::vector<Corners3> seen_before_;
  std::vector<Corners3> after_, seen_after_;  // those that have an area
};

}  // namespace raycone
