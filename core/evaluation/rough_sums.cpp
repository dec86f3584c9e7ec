#include "core/evaluation/rough_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/boundary/winding_number_engine.h"
#include "core/evaluation/sums_round.h"

namespace raycone {
namespace {

// Along each axis: so many nodes as a tile has samples.
constexpr std::size_t kNodes = Interpolation::kOrder;
static_assert(kNodes * kNodes * kNodes <= kTile);

constexpr double kInterpolationCost = 4.0;  // at a sample, in units of a triangle's solid angle

NodeGrid nodes_of(const LatticeRows& rows, const SampleBox& samples) {
  constexpr std::array<std::size_t, 3> kDegrees{kNodes - 1, kNodes - 1, kNodes - 1};
  constexpr std::array<double, kNodes> kUnit{1.0, 1.0, 1.0, 1.0};  // derivatives, of which bends are multiples
  return {rows, samples, kDegrees, kUnit};
}

double largest_at_nodes(const RoughBox& box) {
  double largest = 0.0;
  for (std::size_t n = 0; n < box.nodes.size(); ++n) largest = std::max(largest, std::abs(box.at_nodes[n]));
  return largest;
}

}  // namespace

RoughSums::RoughSums(const LatticeBlocks& blocks, const LatticeRows& rows)
    : blocks_(blocks),
      rows_(rows),
      axes_{rows.xs, rows.ys, rows.zs},
      kernels_{shared_corners_kernel(blocks.level(), Care::kRough), cone_kernel(blocks.level()),
               far_kernel(blocks.level())},
      matrices_(matrix_kernel(blocks.level())),
      doubt_(doubt_of_factors(3 * static_cast<double>(blocks.tree().triangles().size()))),
      covers_(blocks.tree(), axes_, kernels_, blocks.edges()) {}

RoughBox RoughSums::look_at(const SampleBox& samples, double each, const RoughBox* around) const {
  RoughBox box{samples, nodes_of(rows_, samples)};
  const SmallNodes small = samples.size() > kLargest ? SmallNodes::kUnopened : SmallNodes::kOpened;
  box.cover = rough_cover_in(blocks_.tree(), blocks_.extents(), rows_.box_of(samples),
                             {{box.nodes.bend(), box.nodes.growth()}, each, small}, around ? &around->cover : nullptr);
  add_at_nodes(box, around);
  return box;
}

// What `around` interpolates is a polynomial of the same degrees, which the nodes take over as it is.
void RoughSums::add_at_nodes(RoughBox& box, const RoughBox* around) const {
  SampleTile tile;
  const std::vector<std::array<std::size_t, 3>> samples = box.nodes.nodes();
  for (const std::array<std::size_t, 3>& node : samples) tile.add(rows_.query(node));
  const auto set = [&](std::size_t n, double turns, double rest) { box.at_nodes[n] = turns + rest; };
  CoverSums(blocks_.tree(), box.cover.smooth, rows_.box_of(box.samples), kernels_)
      .evaluate(tile, TileShape::kScattered, set);
  blocks_.count_terms(box.cover.smooth, samples.size());
  if (around) {
    const std::span values = std::span(around->at_nodes).first(around->nodes.size());
    const std::vector<double> of_around = around->nodes.at_nodes_of(box.nodes, values);
    for (std::size_t n = 0; n < samples.size(); ++n) box.at_nodes[n] += of_around[n];
  }
  const double taken_over = around ? around->nodes.growth() * largest_at_nodes(*around) : 0.0;
  const double doubt = doubt_of(box.cover.smooth) + kSumsRound * (1 + largest_at_nodes(box) + taken_over);
  box.error = (around ? around->error : 0.0) + box.cover.error + box.nodes.growth() * doubt;
}

double RoughSums::doubt_of(const Cover& cover) const {
  return doubt_ + kRoughness * doubt_of_factors(3 * static_cast<double>(cover.triangles.size()));
}

double RoughSums::cost(const RoughBox& box) {
  return (box.cover.near.cost + kInterpolationCost) * static_cast<double>(box.samples.size());
}

RoughSums::Range RoughSums::range(const RoughBox& box) {
  const auto at_nodes = std::span(box.at_nodes).first(box.nodes.size());
  const bool are_known = std::ranges::none_of(at_nodes, [](double value) { return std::isnan(value); });
  if (!are_known) return {0.0, std::numeric_limits<double>::infinity()};
  const auto [least, most] = std::ranges::minmax(at_nodes);
  return {least / 2 + most / 2, box.nodes.growth() * (most / 2 - least / 2) + box.error};
}

double RoughSums::evaluate(const RoughBox& box, std::vector<double>& numbers) {
  const SampleBox& samples = box.samples;
  const BoxSums sums{numbers, samples};
  numbers.resize(sums.size());
  for (std::size_t z = samples.begin[2]; z < samples.end[2]; ++z) {
    box.nodes.interpolate({box.at_nodes.data(), box.nodes.size()}, samples, z, matrices_, layer_);
    for (std::size_t y = samples.begin[1]; y < samples.end[1]; ++y) {
      const auto row = std::span(layer_.values).subspan((y - samples.begin[1]) * layer_.width, samples.side(0));
      std::ranges::copy(row, sums.row(y, z).begin());
    }
  }
  covers_.add(box.cover.near, rows_.box_of(samples), samples, sums);
  blocks_.count_terms(box.cover.near, samples.size());
  return box.error + box.cover.near_error + doubt_of(box.cover.near);
}

}  // namespace raycone
