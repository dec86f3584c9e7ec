// How LatticeBlocks goes about one lattice.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/data/sample_box.h"
#include "core/far/cover.h"
#include "core/far/far_kernel.h"
#include "core/far/harmonic_polynomial.h"
#include "core/far/lattice_blocks.h"
#include "core/far/lattice_covers.h"
#include "core/far/matrix_kernel.h"
#include "core/far/shared_corners.h"

namespace raycone {

// A harmonic polynomial, the sum of all triangles that are far.
struct FieldOnCube {
  Cube cube;
  Coefficients coefficients;
};

// What the coordinates of axes are of: samples, or the ends of cells, in which scattered points lie. There is one cell
// less than there are coordinates, and one point is expected in each.
enum class AxesOf { kSamples, kCells };

// In samples, or cells, which share a list of what is near: smaller ones make too many lists, larger ones too long.
inline constexpr std::array<std::size_t, 3> kSubBlock{16, 16, 8};

// Samples of a lattice, and what acts on them.
struct SampleBlock {
  std::size_t level = 0;                       // 0: the whole lattice
  SampleBox samples{};                         // or cells of it
  Cube cube{};                                 // around them
  std::vector<std::uint32_t> near{};           // triangles, ascending
  double near_cost = 0.0;                      // of their sum at a sample, in units of a triangle's
  std::shared_ptr<const FieldOnCube> field{};  // none where nothing is far
  double spent = 0.0;                          // of the tolerance: by how much the field is off at most

  // In floating point: the number may not fit in 64 bits.
  [[nodiscard]] double size() const {
    return static_cast<double>(samples.side(0)) * static_cast<double>(samples.side(1)) *
           static_cast<double>(samples.side(2));
  }
};

// What is done with one lattice. Thread-safe once made. Blocks and axes must outlive it.
class LatticeBlocksWalk {
 public:
  // The part of the tolerance that is for multipoles at samples.
  static constexpr double kSampleShare = 0.1;

  LatticeBlocksWalk(const LatticeBlocks& blocks, const LatticeAxes& axes, AxesOf axes_of = AxesOf::kSamples);

  // No field of a block may be off by more.
  [[nodiscard]] double far_budget() const;

  // Children of a block, and those of its triangles that are far from each.
  struct Division {
    std::vector<SampleBlock> children;
    std::vector<Cover> far;
  };

  // The whole lattice, as the only child of nothing.
  [[nodiscard]] Division whole() const;
  // No children where that never pays.
  [[nodiscard]] Division divide(const SampleBlock& block) const;

  // Whether this division of the block takes less time than none.
  [[nodiscard]] bool pays(const SampleBlock& block, const Division& division) const;

  // Gives the children their fields.
  void make_fields(Division& division) const;

  // Of a block that is not divided: its polynomial needs no more than that, 0 where it has none.
  [[nodiscard]] std::size_t degree(const SampleBlock& block) const;
  // Of such a block, what is near those of its samples, or cells, that make up one sub-block.
  [[nodiscard]] Cover cover_at(const SampleBlock& block, const SampleBox& sub_block) const;
  [[nodiscard]] CoverSums sums_of(const Cover& cover, const SampleBox& sub_block) const;
  void count_terms(const Cover& cover, std::size_t samples) const { blocks_.count_terms(cover, samples); }
  void count_polynomials(std::size_t samples) const;

  // Calls the sink for the rows of the part that are in a block that is not divided.
  void evaluate(const SampleBlock& block, const SampleBox& part, const LatticeBlocks::Sink& sink) const;

  [[nodiscard]] static bool overlap(const SampleBlock& block, const SampleBox& part);

  // As LatticeBlocks::cost().
  [[nodiscard]] double cost() const;

 private:
  [[nodiscard]] SampleBlock lattice() const;
  [[nodiscard]] double near_cost(const SampleBlock& block) const;
  [[nodiscard]] double first_of(std::size_t axis, std::size_t first) const { return axes_[axis][first]; }
  [[nodiscard]] double last_of(std::size_t axis, std::size_t last) const {
    return axes_[axis][axes_of_ == AxesOf::kCells ? last : last - 1];
  }
  [[nodiscard]] double length(const SampleBlock& block, std::size_t axis) const;
  [[nodiscard]] std::vector<SampleBlock> halves(const SampleBlock& block) const;
  [[nodiscard]] Cube cube_around(const SampleBlock& block) const;
  [[nodiscard]] Box box_of(const SampleBox& samples) const;
  [[nodiscard]] double estimate(const SampleBlock& block) const;

  // Of the parent's near triangles, or all, those that are far from a child go to the polynomials.
  [[nodiscard]] Division divided_into(std::vector<SampleBlock> children,
                                      std::span<const std::uint32_t> triangles) const;
  // What is far from the block; the others become its near ones.
  [[nodiscard]] Cover far_of(SampleBlock& block, std::span<const std::uint32_t> triangles) const;
  // A list of triangles in two, each ascending, and by how much the fit of the field of those that are far is off at
  // most.
  struct Far {
    std::vector<std::uint32_t> triangles, others;
    double error = 0.0;
  };
  [[nodiscard]] Far far_triangles(const SampleBlock& block, std::span<const std::uint32_t> triangles) const;
  double mark_far(const SampleBlock& block, std::span<const std::uint32_t> triangles, std::span<char> is_far) const;
  // Some of a list of triangles, one after the other, and what they are off by together.
  struct Together {
    double mean_error;
    std::size_t first, count;  // in the list
    double error;
    auto operator<=>(const Together&) const = default;
  };
  // Those that may be far: each by itself is within the budget.
  [[nodiscard]] std::vector<Together> harmless_of(const Cube& cube, std::span<const std::uint32_t> triangles,
                                                  double budget) const;
  [[nodiscard]] double far_budget_of(const SampleBlock& block) const;
  [[nodiscard]] bool can_fit_in(const Cube& cube) const;
  static double error_of(const TriangleExtent& source, const Cube& cube, double moved);
  [[nodiscard]] Cover cover_at_nodes(std::span<const std::uint32_t> far, const Cube& cube) const;

  void add_at_nodes(const Cover& far, const Cube& cube, std::size_t place, std::span<double> values) const;
  void set_layers(const SampleBlock& block, std::size_t degree, GridValues& grid, LatticeCovers& covers,
                  const BoxSums& sums) const;
  void add_near(const SampleBlock& block, const SampleBox& samples, LatticeCovers& covers, const BoxSums& sums) const;

  const LatticeBlocks& blocks_;
  const LatticeAxes& axes_;
  AxesOf axes_of_;
  CoverKernels kernels_;
  MatrixKernel matrices_;
  double near_triangle_;        // at a sample, in units of a triangle that is summed by itself
  std::size_t last_level_ = 0;  // of blocks that may have triangles that are far
};

}  // namespace raycone
