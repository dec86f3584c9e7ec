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

// What each fan of a vertex does. Fans are numbered as they are given; those not named here keep the vertex.
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

// Each fan goes into its inside, or out of it where that leads away from the others, by `distance` in world units. The
// last one keeps the vertex, or else a fan that cannot move. Where several cannot, one of them keeps the vertex and the
// others are cut off: the one that cannot be cut off keeps it, else the one with most faces. Nothing where two can
// neither be moved nor be cut off. Thread-safe.
[[nodiscard]] std::optional<FanParting> parting_inside(const std::vector<FanCone>& fans, double distance);

// How many steps the faces of a mesh have gone against the perturbation, at vertices that were taken apart before.
// `mesh` must stay as it is while this lives.
class FanSteps {
 public:
  explicit FanSteps(const TriangleMesh& mesh) : mesh_(mesh) {}

  // `order`: of the parting that was chosen at the vertex.
  void note(std::uint32_t vertex, const std::vector<FanCone>& fans, const std::vector<std::size_t>& order);

  // Over the corners that a face of each fan has: at how many the face of `one` has gone farther, less those at which
  // that of `other` has.
  [[nodiscard]] int corners_ahead(const FanCone& one, const FanCone& other) const;

 private:
  const TriangleMesh& mesh_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> steps_;  // of faces at corners
};

// The fans go against the perturbation, in an order that is chosen here: the first one stays, the n-th one after it
// goes n times `distance`, in world units. Where either of two fans may leave the other, the one that is ahead at the
// other ends of their edges goes farther; where neither is, the one whose faces lead (FanCone::lead()). Nothing where a
// fan may not leave one that comes before it. Thread-safe.
[[nodiscard]] std::optional<FanParting> parting_against_perturbation(const std::vector<FanCone>& fans, double distance,
                                                                     const FanSteps& steps);

}  // namespace raycone
