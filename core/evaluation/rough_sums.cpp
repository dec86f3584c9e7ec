#include "core/evaluation/rough_sums.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/boundary/boundary_term.h"

namespace raycone {
namespace {

// Along each axis: so many nodes as a tile has samples.
constexpr std::size_t kNodes = Interpolation::kOrder;
static_assert(kNodes * kNodes * kNodes <= kTile);

constexpr double kInterpolation = 4.0;  // at a sample, in units of a triangle's solid angle
constexpr double kSumsRound = 1e-12;    // of sums and products of some numbers, relative to their magnitudes

}  // namespace

RoughSums::RoughSums(const LatticeBlocks& blocks, const LatticeRows& rows)
    : blocks_(blocks),
      rows_(rows),
      axes_{rows.xs, rows.ys, rows.zs},
      kernels_{shared_corners_kernel(blocks.level()), cone_kernel(blocks.level()), far_kernel(blocks.level())},
      matrices_(matrix_kernel(blocks.level())),
      doubt_(doubt_of_factors(3 * static_cast<double>(blocks.tree().triangles().size()))),
      covers_(blocks.tree(), axes_, kernels_, blocks.edges()) {}

void RoughSums::look_at(const SampleBox& box, double each) {
  constexpr std::array<std::size_t, 3> kDegrees{kNodes - 1, kNodes - 1, kNodes - 1};
  constexpr std::array<double, kNodes> kUnit{1.0, 1.0, 1.0, 1.0};  // derivatives, of which bends are multiples
  box_ = box;
  nodes_.emplace(rows_, box, kDegrees, kUnit);
  cover_ =
      rough_cover_in(blocks_.tree(), blocks_.extents(), rows_.box_of(box), {nodes_->bend(), nodes_->growth()}, each);
  summed_ = false;
}

double RoughSums::cost() const { return (cover_.near.cost + kInterpolation) * static_cast<double>(box_.size()); }

std::optional<RoughSums::Range> RoughSums::range() {
  if (cover_.near.cost > 0.0) return std::nullopt;
  sum_at_nodes();
  const auto [least, most] = std::ranges::minmax(std::span(at_nodes_).first(nodes_->size()));
  return Range{least / 2 + most / 2, nodes_->growth() * (most / 2 - least / 2) + largest_error()};
}

double RoughSums::evaluate(std::vector<double>& numbers) {
  const BoxSums sums{numbers, box_};
  numbers.resize(sums.size());
  sum_at_nodes();
  interpolate(sums);
  covers_.add(cover_.near, rows_.box_of(box_), box_, sums);
  blocks_.count_terms(cover_.near, box_.size());
  return largest_error();
}

void RoughSums::sum_at_nodes() {
  if (summed_) return;
  summed_ = true;
  at_nodes_.fill(0.0);
  SampleTile tile;
  tile.clear();
  for (const std::array<std::size_t, 3>& node : nodes_->nodes()) tile.add(rows_.query(node));
  const auto set = [&](std::size_t n, double turns, double rest) { at_nodes_[n] = turns + rest; };
  CoverSums(blocks_.tree(), cover_.smooth, rows_.box_of(box_), kernels_).evaluate(tile, TileShape::kScattered, set);
  blocks_.count_terms(cover_.smooth, nodes_->size());
}

void RoughSums::interpolate(const BoxSums& sums) {
  const SampleBox& box = sums.samples;
  for (std::size_t z = box.begin[2]; z < box.end[2]; ++z) {
    nodes_->interpolate({at_nodes_.data(), nodes_->size()}, box, z, matrices_, layer_);
    for (std::size_t y = box.begin[1]; y < box.end[1]; ++y) {
      const auto row = std::span(layer_.values).subspan((y - box.begin[1]) * layer_.width, box.side(0));
      std::ranges::copy(row, sums.row(y, z).begin());
    }
  }
}

// What the cover leaves out, and what sums at nodes, their interpolation and sums of what is near round.
double RoughSums::largest_error() const {
  double largest = 0.0;
  for (const double value : at_nodes_) largest = std::max(largest, std::abs(value));
  return cover_.error + nodes_->growth() * (2 * doubt_ + kSumsRound * (1 + largest));
}

}  // namespace raycone
