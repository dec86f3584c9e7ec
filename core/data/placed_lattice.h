// Lattices whose axes may point anywhere, as scanners place them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/vec3.h"

namespace raycone {

// The sample (i, j, k) lies at ((origin + i * steps[0]) + j * steps[1]) + k * steps[2], each product and sum rounded to
// double. Along the world's axes that is what Lattice says.
struct PlacedLattice {
  PlacedLattice() = default;
  // A lattice along the axes of the world.
  PlacedLattice(const Lattice& lattice);
  PlacedLattice(const Vec3& at, const std::array<Vec3, 3>& index_steps, const std::array<std::int64_t, 3>& first,
                const std::array<std::int64_t, 3>& count);

  // In its own axes: the indices, and the lengths of the steps as spacing. Where the axes are the world's, it is the
  // whole lattice.
  Lattice grid;
  Vec3 origin;                // world position of index (0, 0, 0), which need not be a sample
  std::array<Vec3, 3> steps;  // world units per index step

  [[nodiscard]] Vec3 position(std::int64_t i, std::int64_t j, std::int64_t k) const;
  // The position of sample `number` of a block, counted i fastest.
  [[nodiscard]] Vec3 position(const LatticeBlock& block, std::size_t number) const;

  // Whether each axis is that of the world, in its direction.
  [[nodiscard]] bool along_axes() const;
  // Of the parallelepiped between the steps; negative where they are left-handed.
  [[nodiscard]] double signed_volume() const { return dot(steps[0], cross(steps[1], steps[2])); }
  // The steps divided by their lengths.
  [[nodiscard]] std::array<Vec3, 3> units() const;
  // These as columns of a matrix, row by row.
  [[nodiscard]] std::array<double, 9> direction() const;
  // Whether the steps span the space, and all samples have finite positions, also while these are summed up.
  [[nodiscard]] bool spans_space() const;
  [[nodiscard]] bool is_finite() const;
  // Whether the steps are orthogonal, within `tolerance` radians, and whether, besides, their lengths are equal within
  // this part of themselves.
  [[nodiscard]] bool is_orthogonal(double tolerance) const;
  [[nodiscard]] bool is_cubic(double tolerance) const;
};

// The box of all samples, up to rounding.
[[nodiscard]] Box box_of(const PlacedLattice& lattice);

// Where in the lattice a place lies, in indices. Precondition: lattice.spans_space().
[[nodiscard]] Vec3 indices_of(const PlacedLattice& lattice, const Vec3& place);

// The same samples, counted along the axes of the world.
struct WorldOrder {
  Lattice lattice;
  std::array<std::size_t, 3> axis_of{};  // the world's, of each axis of the indices
  std::array<bool, 3> mirrored{};        // whether such an axis runs against it

  // The samples of a block of indices.
  [[nodiscard]] LatticeBlock block_of(const LatticeBlock& indices) const;
  // Where the values of these are among those of block_of(indices): of the sample i, j, k steps from the block's first
  // one at start + i * strides[0] + j * strides[1] + k * strides[2].
  struct Walk {
    std::int64_t start = 0;
    std::array<std::int64_t, 3> strides{};
  };
  [[nodiscard]] Walk walk(const LatticeBlock& indices) const;
};

// Nothing where an axis is none of the world's.
[[nodiscard]] std::optional<WorldOrder> world_order(const PlacedLattice& lattice);

}  // namespace raycone
