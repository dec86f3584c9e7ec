// Sums of solid angles at scattered points, as LatticeBlocks has them at samples of a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/data/box.h"
#include "core/data/sample_box.h"
#include "core/far/cover.h"
#include "core/far/lattice_blocks.h"
#include "core/far/lattice_blocks_walk.h"
#include "core/far/polynomial_kernel.h"
#include "core/machine/built_once.h"

namespace raycone {

// A bounded engine for points within a box: cells, about one for each point, are divided into blocks as samples of a
// lattice are. A block is made when points need it first.
//
// A sum is within the tolerance of the blocks, and rounding. It depends on the triangles, their order, the box, the
// number of points that are expected and the point alone: not on the other points, threads or SIMD level.
class PointBlocks {
  // What the points of a group need.
  struct Group {
    const FieldOnCube* field;  // none: no polynomial
    std::size_t degree;        // of its polynomial
    Cover cover;
  };

 public:
  // For about so many points, evenly spread over a box that is not empty and has a size. `blocks` must outlive this.
  PointBlocks(const LatticeBlocks& blocks, const Box& box, double points);
  ~PointBlocks();
  PointBlocks(const PointBlocks&) = delete;  // walk_ refers to axes_
  PointBlocks& operator=(const PointBlocks&) = delete;

  // Cells [0, groups()) of neighbouring points: such a group shares a list of what is near.
  [[nodiscard]] std::uint32_t groups() const { return counts_[0] * counts_[1] * counts_[2]; }
  // The group of a point; none outside of the box.
  [[nodiscard]] std::optional<std::uint32_t> group_of(const Vec3& q) const;

  // How long the sum at a point takes, about; in units of a triangle's solid angle there.
  [[nodiscard]] double cost() const { return walk_.cost(); }

  // Makes what points of these groups need, on all threads. Needs DefaultFloatingPoint. Thread-safe.
  void prepare(std::span<const std::uint32_t> groups) const;

  // The sums at points of one group, which has been prepared. Needs DefaultFloatingPoint; not thread-safe.
  class Sums {
   public:
    Sums(const PointBlocks& blocks, std::uint32_t group);

    // sums[i] for sample i. Fills the tile up.
    void evaluate(SampleTile& samples, std::span<double> sums);

   private:
    const PointBlocks& blocks_;
    const Group& group_;
    CoverSums cover_sums_;
  };

 private:
  struct Block;

  [[nodiscard]] SampleBox cells_of(std::uint32_t group) const;
  Block& whole() const;
  // The parts of a block; none if it is not divided.
  const std::vector<std::unique_ptr<Block>>& parts_of(Block& block) const;
  // Makes a group in a block that is not divided.
  void make_group(std::uint32_t group, const Block& block) const;

  LatticeAxes axes_;
  std::array<std::uint32_t, 3> counts_;  // of groups
  Vec3 cells_per_unit_;
  LatticeBlocksWalk walk_;
  PolynomialKernel polynomial_;
  BuiltOnce<std::unique_ptr<Block>> whole_;
  std::unique_ptr<BuiltOnce<Group>[]> groups_;  // refer to fields of blocks
};

}  // namespace raycone
