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

// The faces of a fan, as seen from its vertex: a cone with the solid behind it. In doubles, not exact: what is built by
// it must be checked.
class FanCone {
 public:
  FanCone(const TriangleMesh& mesh, std::uint32_t vertex, const std::vector<std::uint32_t>& faces);

  [[nodiscard]] const std::vector<std::uint32_t>& faces() const { return faces_; }

  // A direction from the vertex within a face. Not the middle of the face: there, symmetric meshes would have edges of
  // other fans level with it.
  [[nodiscard]] Vec3 way_along() const;

  // A direction of length 1 in which the vertex can leave `others` (directions): behind all faces where all of `others`
  // are in front of the cone, in front of all faces where all are behind it. None where neither is so, where no
  // direction is clearly on one side of all faces, or where there are more than 64.
  [[nodiscard]] std::optional<Vec3> way_from(const std::vector<Vec3>& others) const;

  // Whether this fan can move a little along `way` without passing through `other`, a fan of the same vertex.
  [[nodiscard]] bool leaves(const FanCone& other, const Vec3& way) const;

  // Whether moving along `way` takes each face against the perturbation, or leaves it in its plane. Points on a face
  // are then on the side of it where the perturbation has them.
  [[nodiscard]] bool goes_against_perturbation(const Vec3& way) const;

  // How far this fan is ahead of `other` along `way`: of its faces at edges that both have, the cosines between `way`
  // and the direction from the edge into the face, added up. The same at all vertices along an edge with the same
  // faces.
  [[nodiscard]] double lead(const FanCone& other, const Vec3& way) const;

  // On which side lid_of() finds a lid to cut the vertex off: -1 within the solid, 1 outside. None for neither.
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

// Cuts a polygon of directions into triangles by cutting off ears, as of a polygon in a plane. Returns the triangles by
// the numbers of their directions. Seen from where the directions start, they cover the polygon once; its inside is on
// its right (side -1) or on its left (side 1). None where no ear is found, and for fewer than 3 or more than 256
// directions.
[[nodiscard]] std::optional<std::vector<std::array<std::size_t, 3>>> lid_of(const std::vector<Vec3>& polygon,
                                                                            double side);

}  // namespace raycone
