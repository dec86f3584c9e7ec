// Bricks of a surface: faces that lie in one part of a lattice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"
#include "core/data/vec3.h"
#include "core/machine/sorted_by_key.h"

namespace raycone {

// Bricks that have faces, numbered in the order of their first ones.
struct SurfaceBricks {
  static constexpr std::uint32_t kNone = 0xFFFFFFFF, kUnmet = 0xFFFFFFFE;

  SortedByKey<std::uint32_t> faces;   // by brick, their numbers
  std::vector<std::uint32_t> owner;   // of each vertex the brick that has all of its faces; kNone where several bricks
                                      // have some, kUnmet where none has
  std::vector<std::uint32_t> places;  // of each brick among all of the lattice's, with faces or without

  [[nodiscard]] std::size_t count() const { return faces.keys(); }
  [[nodiscard]] std::uint32_t place_of_owner(std::uint32_t vertex) const {
    return owner[vertex] < count() ? places[owner[vertex]] : owner[vertex];
  }
  // The brick at each place up to the last one that has faces; kNone where there is none.
  [[nodiscard]] std::vector<std::uint32_t> by_place() const;
};

// A face is in the brick of its first corner. Bricks have sides of 32 voxels, and are all moved along each axis by
// `shift`, a fraction of a side. Uses the threads that ThreadLimit allows; the same for any number of them.
[[nodiscard]] SurfaceBricks bricks_of(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                                      const Lattice& lattice, double shift);

// All triangles in one brick, which has no place: place_of_owner() is not to be asked. `vertices`: how many there are.
[[nodiscard]] SurfaceBricks one_brick_of(std::size_t vertices, const std::vector<Triangle>& triangles);

}  // namespace raycone
