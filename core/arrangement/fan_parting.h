// Ways for the fans of faces that share a vertex to get a vertex each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/arrangement/fan_cone.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// Fans are numbered as they are given. What is not named here keeps the vertex.
struct FanParting {
  struct Move {
    std::size_t fan;
    Vec3 step;  // from the vertex, world units
  };
  struct Cut {
    std::size_t fan;
    double side;  // of the lid: within the solid, -1, or outside of it, 1
  };
  std::vector<Move> moves;
  std::vector<Cut> cuts;
  std::vector<std::size_t> order;  // against the perturbation: the fans, the one that stays first
};

// Each fan goes into its inside, or out of it where that is the way to go: the last one, or one that cannot move, keeps
// the vertex. Of several that cannot, all but that with most faces are cut off. Nothing where two of these cannot be
// cut off either. Thread-safe.
[[nodiscard]] std::optional<FanParting> parting_inside(const std::vector<FanCone>& fans, double distance);

// How many steps the faces of a mesh have gone against the perturbation at vertices that were taken apart before.
// `mesh`: stays as it is meanwhile.
class FanSteps {
 public:
  explicit FanSteps(const TriangleMesh& mesh) : mesh_(mesh) {}

  // `order`: of the parting that was chosen at the vertex.
  void note(std::uint32_t vertex, const std::vector<FanCone>& fans, const std::vector<std::size_t>& order);

  // At how many corners that faces of both have one has gone farther, less those at which the other one has.
  [[nodiscard]] int corners_ahead(const FanCone& one, const FanCone& other) const;

 private:
  const TriangleMesh& mesh_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> steps_;  // of faces at corners
};

// Against the perturbation: of the order that is found the first fan stays, and each other one goes a distance farther
// than those before it, away from them. Of two that may leave each other, the one that is ahead at the other ends of
// their edges is ahead, or the one whose faces are. Nothing where one may not leave another that is before it.
// Thread-safe.
[[nodiscard]] std::optional<FanParting> parting_against_perturbation(const std::vector<FanCone>& fans, double distance,
                                                                     const FanSteps& steps);

}  // namespace raycone
