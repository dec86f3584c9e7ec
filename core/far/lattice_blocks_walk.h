// How LatticeBlocks goes about one lattice.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/far/cover.h"
#include "core/far/far_kernel.h"
#include "core/far/harmonic_error.h"
#include "core/far/harmonic_fit.h"
#include "core/far/lattice_blocks.h"
#include "core/far/shared_corners.h"

namespace raycone {

// The tolerance is spent on far triangles, the same share at each level of blocks; on coefficients left out; and on
// multipoles, at nodes, where fits multiply their errors, and at samples.
inline constexpr double kFarShare = 0.6;
inline constexpr double kTruncationShare = 0.05;
inline constexpr double kNodeShare = 0.15;
inline constexpr double kSampleShare = 0.1;

// Times, in units of that of a triangle at a sample.
inline constexpr double kFitting = 8000.0;  // of making a block's polynomial, beside the triangles at its nodes
inline constexpr double kPolynomial = 3.0;  // of the polynomial at a sample

// In samples. Blocks smaller than this are not divided, larger ones if that pays, ...
inline constexpr double kSmallBlock = 0x1p12;
inline constexpr double kLargeBlock = 0x1p15;                    // ... those beyond this always, or beyond ...
inline constexpr double kLargestBlock = 0x1p18;                  // ... this where nothing is near.
inline constexpr std::array<std::size_t, 3> kSubBlock{8, 8, 4};  // samples that share a list of what is near

// Cubes are larger than their blocks by this factor: on their faces nodes would lie in the planes of samples, where
// many meshes have flat boundaries, and the sides of triangles would be ties.
inline constexpr double kMargin = 1.0 + 0x1.3p-9;

// A harmonic polynomial, the sum of all triangles that are far.
struct FieldOnCube {
  Cube cube;
  Coefficients coefficients;
};

struct SampleBlock {
  std::size_t level;  // 0: the whole lattice
  std::array<std::size_t, 3> first, last;
  Cube cube;
  std::vector<std::uint32_t> near;  // triangles, ascending
  double near_cost;                 // of their sum at a sample
  std::shared_ptr<const FieldOnCube> field;

  [[nodiscard]] std::size_t count(std::size_t axis) const { return last[axis] - first[axis]; }
  [[nodiscard]] double size() const {
    return static_cast<double>(count(0)) * static_cast<double>(count(1)) * static_cast<double>(count(2));
  }
};

// Sums of the samples [first, last) along each axis, in rows of GridValues::row_size().
struct BlockSums {
  std::vector<double>& numbers;
  std::array<std::size_t, 3> first, last;

  [[nodiscard]] std::size_t row_size() const { return GridValues::row_size(last[0] - first[0]); }
  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const {
    return ((z - first[2]) * (last[1] - first[1]) + y - first[1]) * row_size() + x - first[0];
  }
};

// What is done with one lattice.
class LatticeBlocksWalk {
 public:
  LatticeBlocksWalk(const LatticeBlocks& blocks, const LatticeAxes& axes)
      : blocks_(blocks),
        axes_(axes),
        shared_corners_(shared_corners_kernel(blocks.level_)),
        far_(far_kernel(blocks.level_)),
        matrices_(matrix_kernel(blocks.level_)) {
    for (SampleBlock block = lattice(); block.size() >= kSmallBlock; ++levels_) {
      std::vector<SampleBlock> parts = halves(block);
      if (parts.size() < 2) break;
      block = *std::ranges::max_element(parts, {}, &SampleBlock::size);
    }
    far_budget_ = kFarShare * blocks.tolerance_ / static_cast<double>(levels_);
  }

  // Levels of blocks that may have triangles that are far: so often the budget of a level is spent on a sample at most.
  [[nodiscard]] std::size_t levels() const { return levels_; }

  // Children of a block, and those of its triangles that are far from each.
  struct Division {
    std::vector<SampleBlock> children;
    std::vector<Cover> far;
  };

  // The whole lattice, as the only child of nothing.
  [[nodiscard]] Division whole() const {
    std::vector<std::uint32_t> triangles(blocks_.sources_.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = static_cast<std::uint32_t>(i);
    Division division;
    add_child(lattice(), triangles, division);
    return division;
  }

  [[nodiscard]] Division divide(const SampleBlock& block) const {
    Division division;
    for (SampleBlock& child : halves(block)) add_child(std::move(child), block.near, division);
    return division;
  }

  // Of a block and of the children of its division.
  [[nodiscard]] bool pays(const SampleBlock& block, const Division& division) const {
    if (division.children.size() < 2) return false;
    if (block.near.empty()) return block.size() > kLargestBlock;
    if (block.size() > kLargeBlock) return true;
    if (block.size() < kSmallBlock) return false;
    double cost = 0.0;
    for (std::size_t n = 0; n < division.children.size(); ++n) {
      cost += making_cost(division.far[n].cost, block.field != nullptr) + near_cost(division.children[n]);
    }
    return cost < near_cost(block);
  }

  [[nodiscard]] static double making_cost(double far, bool parent) {
    return far > 0.0 || parent ? far * static_cast<double>(HarmonicFit::kNodes) + kFitting : 0.0;
  }
  [[nodiscard]] static double near_cost(const SampleBlock& block) {
    return (block.near_cost + kPolynomial) * block.size();
  }

  // The time for a block, from some of its parts: opposite ones, and further in other ones.
  [[nodiscard]] double estimate(const SampleBlock& block, std::size_t depth) const {
    constexpr std::array<std::uint32_t, 2> kSome{0b01101001, 0b10010110};
    constexpr std::uint32_t kFew = 0b10000001;
    constexpr std::size_t kDeep = 4;
    const Division division = divide(block);
    if (!pays(block, division)) return near_cost(block);
    double making = 0.0, inside = 0.0, looked_at = 0.0;
    for (std::size_t n = 0; n < division.children.size(); ++n) {
      making += making_cost(division.far[n].cost, true);
      if (((depth < kDeep ? kSome[depth % 2] : kFew) >> n) % 2 == 0) continue;
      inside += estimate(division.children[n], depth + 1);
      looked_at += division.children[n].size();
    }
    return making + inside * (block.size() / looked_at);
  }

  // Gives the children their fields.
  void make_fields(Division& division) const {
    std::vector<double> values(HarmonicFit::kNodes * HarmonicFit::kTogether);
    std::vector<Coefficients> fits(division.children.size());
    bool any = false;
    for (std::size_t n = 0; n < fits.size(); ++n) {
      any = any || division.far[n].cost > 0.0;
      add_at_nodes(division.far[n], division.children[n].cube, n, values);
    }
    if (!any) return;  // the parent's field, if any, does for all
    HarmonicFit::instance().fit(values, fits, matrices_);
    for (std::size_t n = 0; n < fits.size(); ++n) {
      if (division.far[n].cost == 0.0) continue;
      SampleBlock& child = division.children[n];
      if (child.field) {
        const Coefficients other = on_cube(child.field->coefficients, child.field->cube, child.cube, matrices_);
        for (std::size_t i = 0; i < other.size(); ++i) fits[n][i] += other[i];
      }
      child.field = std::make_shared<const FieldOnCube>(FieldOnCube{child.cube, fits[n]});
    }
  }

  void evaluate(const SampleBlock& block, const std::array<SampleRange, 3>& part,
                const LatticeBlocks::Sink& sink) const;

  [[nodiscard]] static bool overlap(const SampleBlock& block, const std::array<SampleRange, 3>& part) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(part[axis].begin < block.last[axis] && block.first[axis] < part[axis].end)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] SampleBlock lattice() const {
    return {0, {0, 0, 0}, {axes_[0].size(), axes_[1].size(), axes_[2].size()}, {}, {}, 0.0, nullptr};
  }

  [[nodiscard]] double length(const SampleBlock& block, std::size_t axis) const {
    return axes_[axis][block.last[axis] - 1] - axes_[axis][block.first[axis]];
  }

  // Cut so that sub-blocks are whole, but for those at the end of the lattice.
  [[nodiscard]] static std::size_t middle_of(const SampleBlock& block, std::size_t axis) {
    const std::size_t half = block.count(axis) / 2, step = kSubBlock[axis];
    return block.first[axis] + (half < step ? half : (half + step / 2) / step * step);
  }

  // The block cut in two along its longer axes.
  [[nodiscard]] std::vector<SampleBlock> halves(const SampleBlock& block) const {
    const double longest = std::max({length(block, 0), length(block, 1), length(block, 2)});
    std::vector<SampleBlock> pieces{{block.level + 1, block.first, block.last, {}, {}, 0.0, block.field}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.count(axis) < 2 || length(block, axis) <= 0.6 * longest) continue;
      const std::size_t middle = middle_of(block, axis), count = pieces.size();
      for (std::size_t n = 0; n < count; ++n) {
        SampleBlock upper = pieces[n];
        pieces[n].last[axis] = upper.first[axis] = middle;
        pieces.push_back(std::move(upper));
      }
    }
    return pieces;
  }

  [[nodiscard]] Cube cube_around(const SampleBlock& block) const {
    Cube cube{{}, 0.0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double first = axes_[axis][block.first[axis]], last = axes_[axis][block.last[axis] - 1];
      cube.centre[static_cast<int>(axis)] = first / 2 + last / 2;
      cube.half = std::max(cube.half, (last / 2 - first / 2) * kMargin);
    }
    return cube;
  }

  // Which triangles are far: as many as the budget allows, the most harmless first. A block that is deeper than the
  // largest ones ever are has none.
  void add_child(SampleBlock block, std::span<const std::uint32_t> triangles, Division& division) const {
    block.cube = cube_around(block);
    std::vector<std::pair<double, std::uint32_t>> errors;
    for (const std::uint32_t n : triangles) {
      if (block.level >= levels_) break;
      const double error = error_of(blocks_.sources_[n], block.cube);
      if (error <= far_budget_) errors.emplace_back(error, n);
    }
    std::ranges::sort(errors);
    double sum = 0.0;
    std::vector<std::uint32_t> far;
    for (const auto& [error, n] : errors) {
      if ((sum += error) > far_budget_) break;
      far.push_back(n);
    }
    std::ranges::sort(far);
    Cover cover = cover_at_nodes(far, block.cube);
    if (making_cost(cover.cost, false) > static_cast<double>(far.size()) * block.size()) far.clear(), cover = {};
    std::ranges::set_difference(triangles, far, std::back_inserter(block.near));
    block.near_cost = cover_at_samples(block, block.first, block.last).cost;
    division.far.push_back(std::move(cover));
    division.children.push_back(std::move(block));
  }

  // By how much the block's polynomial is off at most because of a triangle; infinite or NaN if that is not known.
  static double error_of(const LatticeBlocks::Source& source, const Cube& cube) {
    double distance = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      distance =
          std::max({distance, source.box.lower[axis] - cube.centre[axis], cube.centre[axis] - source.box.upper[axis]});
    }
    // Rounding of the quotients must make it no larger.
    return source.area / (cube.half * cube.half) * dipole_error(distance / cube.half * (1 - 0x1p-40));
  }

  [[nodiscard]] Box box_of(const std::array<std::size_t, 3>& first, const std::array<std::size_t, 3>& last) const {
    Box box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.lower[static_cast<int>(axis)] = axes_[axis][first[axis]];
      box.upper[static_cast<int>(axis)] = axes_[axis][last[axis] - 1];
    }
    return box;
  }

  [[nodiscard]] static Box box_of(const Cube& cube) {
    const Vec3 half{cube.half, cube.half, cube.half};
    return {cube.centre - half, cube.centre + half};
  }

  [[nodiscard]] Cover cover_at_nodes(std::span<const std::uint32_t> far, const Cube& cube) const {
    return cover_in(blocks_.tree_, far, box_of(cube), kNodeShare * blocks_.tolerance_ / HarmonicFit::kLargestWeights);
  }
  [[nodiscard]] Cover cover_at_samples(const SampleBlock& block, const std::array<std::size_t, 3>& first,
                                       const std::array<std::size_t, 3>& last) const {
    return cover_in(blocks_.tree_, block.near, box_of(first, last), kSampleShare * blocks_.tolerance_);
  }

  void add_at_nodes(const Cover& far, const Cube& cube, std::size_t place, std::span<double> values) const {
    if (far.cost == 0.0) return;
    const HarmonicFit& fit = HarmonicFit::instance();
    CoverSums sums(blocks_.tree_, far, box_of(cube), shared_corners_, far_);
    count_terms(far, HarmonicFit::kNodes);
    SampleTile nodes;
    for (std::size_t begin = 0; begin < HarmonicFit::kNodes; begin += kTile) {
      nodes.clear();
      for (std::size_t n = begin; n < std::min(begin + kTile, HarmonicFit::kNodes); ++n) {
        nodes.add(cube.centre + cube.half * fit.node(n));
      }
      sums.evaluate(nodes, TileShape::kScattered, [&](std::size_t i, double turns, double rest) {
        values[(begin + i) * HarmonicFit::kTogether + place] = turns + rest;
      });
    }
  }

  void count_terms(const Cover& cover, std::size_t samples) const {
    blocks_.near_terms_.fetch_add(samples * cover.triangles.size(), std::memory_order_relaxed);
    blocks_.far_terms_.fetch_add(samples * cover.expansions.size(), std::memory_order_relaxed);
  }

  // Adds what is near to the sums of the samples [begin, end) of a sub-block.
  void add_near(const SampleBlock& block, const std::array<std::size_t, 3>& begin,
                const std::array<std::size_t, 3>& end, const BlockSums& sums) const;

  const LatticeBlocks& blocks_;
  const LatticeAxes& axes_;
  SharedCornersKernel shared_corners_;
  FarKernel far_;
  MatrixKernel matrices_;
  std::size_t levels_ = 1;
  double far_budget_;  // of a level
};

}  // namespace raycone
