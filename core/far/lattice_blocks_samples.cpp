// The sums at the samples of blocks: polynomials, and what is near.
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/crossings/crossings.h"
#include "core/far/lattice_blocks_walk.h"

namespace raycone {
namespace {

// The time of an edge of the boundary of what is near, in units of that of a triangle.
constexpr double kEdge = 0.85;

// Where the sub-block ends that `at` is in. Sub-blocks begin where they do for the whole block.
std::size_t end_of_sub_block(const SampleBlock& block, std::size_t axis, std::size_t at) {
  return at + kSubBlock[axis] - (at - block.first[axis]) % kSubBlock[axis];
}

}  // namespace

void LatticeBlocksWalk::evaluate(const SampleBlock& block, const std::array<SampleRange, 3>& part,
                                 const LatticeBlocks::Sink& sink) const {
  const std::size_t degree = this->degree(block);
  GridValues grid(matrices_);
  std::optional<SharedEdges::Boundary> boundary;
  if (blocks_.edges_) boundary.emplace(*blocks_.edges_);
  std::vector<double> numbers;
  std::array<std::size_t, 3> first, last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::max<std::size_t>(block.first[axis], part[axis].begin);
    last[axis] = std::min<std::size_t>(block.last[axis], part[axis].end);
  }
  for (std::size_t begin = first[2], end; begin < last[2]; begin = end) {
    end = std::min(last[2], end_of_sub_block(block, 2, begin));
    const BlockSums sums{numbers, {first[0], first[1], begin}, {last[0], last[1], end}};
    set_layers(block, degree, grid, boundary ? &*boundary : nullptr, sums);
    for (std::size_t z = begin; z < end; ++z) {
      for (std::size_t y = first[1]; y < last[1]; ++y) {
        sink(first[0], y, z, std::span(numbers).subspan(sums.place(first[0], y, z), last[0] - first[0]));
      }
    }
  }
}

// As many layers along z as a sub-block has: the polynomial up to `degree`, and what is near.
void LatticeBlocksWalk::set_layers(const SampleBlock& block, std::size_t degree, GridValues& grid,
                                   SharedEdges::Boundary* boundary, const BlockSums& sums) const {
  const std::array<std::size_t, 3>&first = sums.first, &last = sums.last;
  const auto coordinates = [&](std::size_t axis) {
    return std::span(axes_[axis]).subspan(first[axis], last[axis] - first[axis]);
  };
  if (block.field) {
    count_polynomials((last[0] - first[0]) * (last[1] - first[1]) * (last[2] - first[2]));
    const auto values = grid.evaluate(block.field->coefficients, degree, block.field->cube, coordinates(0),
                                      coordinates(1), coordinates(2));
    sums.numbers.assign(values.begin(), values.end());
  } else {
    sums.numbers.assign(sums.row_size() * (last[1] - first[1]) * (last[2] - first[2]), 0.0);
  }
  if (block.near.empty()) return;
  std::array<std::size_t, 3> begin = first, end = last;
  for (; begin[1] < last[1]; begin[1] = end[1]) {
    end[1] = std::min(last[1], end_of_sub_block(block, 1, begin[1]));
    for (begin[0] = first[0]; begin[0] < last[0]; begin[0] = end[0]) {
      end[0] = std::min(last[0], end_of_sub_block(block, 0, begin[0]));
      add_near(block, begin, end, boundary, sums);
    }
  }
}

// Which nodes are far is a matter of the whole sub-block, whatever part of it is asked for.
void LatticeBlocksWalk::add_near(const SampleBlock& block, const std::array<std::size_t, 3>& begin,
                                 const std::array<std::size_t, 3>& end, SharedEdges::Boundary* boundary,
                                 const BlockSums& sums) const {
  std::array<std::size_t, 3> first, last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = begin[axis] - (begin[axis] - block.first[axis]) % kSubBlock[axis];
    last[axis] = std::min(block.last[axis], first[axis] + kSubBlock[axis]);
  }
  const Cover cover = cover_at(block, first, last);
  count_terms(cover, (end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]));
  const std::span<const ChainStep> steps = boundary ? boundary->of(cover.triangles) : std::span<const ChainStep>();
  const bool by_boundary =
      boundary && kEdge * static_cast<double>(boundary->edges()) < static_cast<double>(cover.triangles.size());
  if (by_boundary) add_crossings(cover.triangles, begin, end, sums);
  CoverSums cover_sums = by_boundary ? CoverSums(blocks_.tree_, cover, steps, kernels_) : sums_of(cover, first, last);
  add_at_samples(cover_sums, last[0] - first[0] <= kSubBlock[0] / 2, begin, end, sums);
}

// `narrow`: whether rows would leave half of their lanes idle. Then samples are taken as they come.
void LatticeBlocksWalk::add_at_samples(CoverSums& cover_sums, bool narrow, const std::array<std::size_t, 3>& begin,
                                       const std::array<std::size_t, 3>& end, const BlockSums& sums) const {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  SampleTile tile;
  std::array<std::size_t, kTile> places;  // among the sums; kNone: of an idle lane
  tile.clear();
  const auto add = [&](std::size_t x, std::size_t y, std::size_t z) {
    places[tile.count] = x < end[0] ? sums.place(x, y, z) : kNone;
    tile.add({axes_[0][std::min(x, end[0] - 1)], axes_[1][y], axes_[2][z]});
  };
  const auto evaluate = [&](TileShape shape, std::size_t beyond) {
    cover_sums.evaluate(tile, shape, [&](std::size_t i, double turns, double rest) {
      if (places[i] == kNone) return;
      double& sum = sums.numbers[places[i] + beyond];
      sum = turns + (rest + sum);
    });
  };
  if (narrow) {
    for (std::size_t z = begin[2]; z < end[2]; ++z) {
      for (std::size_t y = begin[1]; y < end[1]; ++y) {
        for (std::size_t x = begin[0]; x < end[0]; ++x) {
          add(x, y, z);
          if (tile.count == kTile) evaluate(TileShape::kScattered, 0), tile.clear();
        }
      }
    }
    if (tile.count > 0) evaluate(TileShape::kScattered, 0);
    return;
  }
  for (std::size_t y = begin[1]; y < end[1]; ++y) {
    for (std::size_t x = begin[0]; x < begin[0] + kSubBlock[0]; ++x) add(x, y, begin[2]);
  }
  for (std::size_t z = begin[2]; z < end[2]; ++z) {
    tile.z.fill(axes_[2][z]);
    evaluate(TileShape::kInRows, sums.place(begin[0], begin[1], z) - sums.place(begin[0], begin[1], begin[2]));
  }
}

// Those of the rays of samples with triangles, which what their boundary adds wants in addition.
void LatticeBlocksWalk::add_crossings(std::span<const std::uint32_t> triangles, const std::array<std::size_t, 3>& begin,
                                      const std::array<std::size_t, 3>& end, const BlockSums& sums) const {
  const std::span xs = std::span(axes_[0]).subspan(begin[0], end[0] - begin[0]);
  const auto range = [&](std::size_t axis, const Box& box) {  // of samples in the box's extent
    const std::span along = std::span(axes_[axis]).subspan(begin[axis], end[axis] - begin[axis]);
    const auto lower = std::ranges::lower_bound(along, box.lower[static_cast<int>(axis)]);
    const auto upper = std::ranges::upper_bound(along, box.upper[static_cast<int>(axis)]);
    return std::pair(begin[axis] + static_cast<std::size_t>(lower - along.begin()),
                     begin[axis] + static_cast<std::size_t>(upper - along.begin()));
  };
  for (const std::uint32_t n : triangles) {
    const Box& box = blocks_.sources_[n].box;
    if (box.upper.x < xs.front()) continue;
    const auto [y_begin, y_end] = range(1, box);
    const auto [z_begin, z_end] = range(2, box);
    if (y_begin >= y_end || z_begin >= z_end) continue;
    const SolidTriangle& t = blocks_.tree_.triangles()[n];
    const TrianglePlane plane(t.a, t.b, t.c);
    for (std::size_t z = z_begin; z < z_end; ++z) {
      for (std::size_t y = y_begin; y < y_end; ++y) {
        const TriangleCrossing crossing = triangle_crossing(t.a, t.b, t.c, {axes_[1][y], axes_[2][z], xs}, &plane);
        const double turns = t.orientation * crossing.sigma;
        double* const row = &sums.numbers[sums.place(begin[0], y, z)];
        for (std::size_t i = 0; i < crossing.crossed; ++i) row[i] += turns;
      }
    }
  }
}

}  // namespace raycone
