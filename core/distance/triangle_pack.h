// Eight triangles side by side, prepared for distances to many points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/data/box.h"
#include "core/data/triangle_mesh.h"
#include "core/distance/accurate_distance.h"
#include "core/distance/triangle_distance.h"

namespace raycone {

// One column per number of TriangleDistance. Kernels load a column into SIMD lanes, or one entry of it into all lanes.
struct alignas(64) TrianglePack {
  static constexpr std::size_t kWidth = 8;
  using Column = std::array<double, kWidth>;
  using Columns = std::array<Column, 3>;  // by axis, or by edge

  std::array<Columns, 3> corners;
  Columns inverse_square;
  Columns to_v, to_w;
  Column sure_from, sure_up_to, direction_from;
  Column shape;  // 0: proper, 1: slender, 2: flat

  // To one to eight triangles of `mesh`; the last one fills the rest.
  void set(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles);

  // Sets a slot to one of another pack.
  void copy(std::size_t slot, const TrianglePack& from, std::size_t from_slot);

  // Of all corners.
  [[nodiscard]] Box box() const;
  [[nodiscard]] Vec3 corner(std::size_t corner, std::size_t slot) const {
    const Columns& at = corners[corner];
    return {at[0][slot], at[1][slot], at[2][slot]};
  }
  // The triangle of a slot, prepared as it was for the columns.
  [[nodiscard]] TriangleDistance triangle(std::size_t slot) const {
    return {corner(0, slot), corner(1, slot), corner(2, slot)};
  }
  // Whether care is accurate()'s, wherever the point is.
  [[nodiscard]] bool is_thin(std::size_t slot) const { return shape[slot] > 0.0; }
  [[nodiscard]] AccurateTriangle accurate(std::size_t slot) const {
    return {corner(0, slot), corner(1, slot), corner(2, slot)};
  }
};

}  // namespace raycone
