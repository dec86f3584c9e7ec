// The faces around a vertex, as directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"

namespace raycone {

// The faces of a fan, as seen from its vertex: a cone that the solid is behind. In doubles: whatever is made of it must
// be looked at.
class FanCone {
 public:
  FanCone(const TriangleMesh& mesh, std::uint32_t vertex, const std::vector<std::uint32_t>& faces);

  [[nodiscard]] const std::vector<std::uint32_t>& faces() const { return faces_; }

  // Away from the vertex, within a face; not in its middle, for what is symmetric would be level with edges of others.
  [[nodiscard]] Vec3 way_along() const;

  // A direction of length 1 for the vertex to move in, with all faces on one side, so that it goes away from `others`,
  // which are directions: behind all faces if these are all in front, and the other way round.
  [[nodiscard]] std::optional<Vec3> way_from(const std::vector<Vec3>& others) const;

  // Whether this fan, moved a bit in a direction, goes away from another one of the same vertex.
  [[nodiscard]] bool leaves(const FanCone& other, const Vec3& way) const;

  // Whether each face, moved in a direction, goes against the perturbation, or stays in its plane: points on it are
  // then on the side of it that they are on as perturbed.
  [[nodiscard]] bool goes_against_perturbation(const Vec3& way) const;

  // How far a fan's faces at edges that another one has, too, are ahead in a direction: the same at all vertices along
  // an edge where these are the faces.
  [[nodiscard]] double lead(const FanCone& other, const Vec3& way) const;

  // On which side lid_of() finds a lid to cut the vertex off: within the solid, -1, or outside, 1. None for neither.
  [[nodiscard]] std::optional<double> side_of_lid() const;

 private:
  using Sector = std::array<Vec3, 2>;  // the edges of a face that leave the vertex

  [[nodiscard]] std::optional<Vec3> way_with_all_on_side(double side) const;
  [[nodiscard]] bool are_on_one_side(const Vec3& from, const Vec3& to) const;
  [[nodiscard]] bool has_edge(const Vec3& direction) const;
  [[nodiscard]] std::vector<Vec3> ring() const;

  std::vector<std::uint32_t> faces_;
  std::vector<Sector> sectors_;
};

// Triangles, given as numbers of directions, that are to a polygon of directions what ears cut off make of a polygon in
// a plane: seen from where the directions start they cover it once, the polygon's inside being on its right (side -1)
// or on its left (1). None where no ears are found, and of more than 256 directions.
[[nodiscard]] std::optional<std::vector<std::array<std::size_t, 3>>> lid_of(const std::vector<Vec3>& polygon,
                                                                            double side);

}  // namespace raycone
