#include "core/distance/triangle_pack.h"

#include <algorithm>

namespace raycone {

void TrianglePack::set(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  for (std::size_t slot = 0; slot < kWidth; ++slot) {
    const Triangle& t = mesh.triangles[triangles[std::min(slot, triangles.size() - 1)]];
    const TriangleDistance distance(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    for (std::size_t n = 0; n < 3; ++n) {
      const int axis = static_cast<int>(n);
      for (std::size_t corner = 0; corner < 3; ++corner) corners[corner][n][slot] = mesh.vertices[t[corner]][axis];
      to_v[n][slot] = distance.to_v_[axis];
      to_w[n][slot] = distance.to_w_[axis];
      inverse_square[n][slot] = distance.inverse_square_[n];
    }
    sure_from[slot] = distance.sure_from_;
    sure_up_to[slot] = distance.sure_up_to_;
    direction_from[slot] = distance.direction_from_;
    shape[slot] = static_cast<double>(distance.shape_);
  }
}

Box TrianglePack::box() const {
  Box all = empty_box();
  for (std::size_t slot = 0; slot < kWidth; ++slot)
    extend(all, box_of(corner(0, slot), corner(1, slot), corner(2, slot)));
  return all;
}

void TrianglePack::copy(std::size_t slot, const TrianglePack& from, std::size_t from_slot) {
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) corners[n][axis][slot] = from.corners[n][axis][from_slot];
    inverse_square[n][slot] = from.inverse_square[n][from_slot];
    to_v[n][slot] = from.to_v[n][from_slot];
    to_w[n][slot] = from.to_w[n][from_slot];
  }
  sure_from[slot] = from.sure_from[from_slot];
  sure_up_to[slot] = from.sure_up_to[from_slot];
  direction_from[slot] = from.direction_from[from_slot];
  shape[slot] = from.shape[from_slot];
}

}  // namespace raycone
