#include "core/far/lattice_covers.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/boundary/sample_tile.h"
#include "core/crossings/crossings.h"

namespace raycone {
namespace {

// The time of an edge of the boundary of what is near, in units of that of a triangle.
constexpr double kEdge = 0.85;

constexpr std::size_t kRow = 8;  // samples of a row in a tile, and rows

}  // namespace

LatticeCovers::LatticeCovers(const SourceTree& tree, const LatticeAxes& axes, const CoverKernels& kernels,
                             const SharedEdges* edges)
    : tree_(tree), axes_(axes), kernels_(kernels) {
  if (edges) boundary_.emplace(*edges);
}

void LatticeCovers::add(const Cover& cover, const Box& box, const SampleBox& samples, const BoxSums& sums) {
  const auto most_edges = static_cast<std::size_t>(static_cast<double>(cover.triangles.size()) / kEdge);
  const auto steps = boundary_ ? boundary_->of(cover.triangles, most_edges) : std::nullopt;
  if (steps) add_crossings(cover.triangles, samples, sums);
  CoverSums of_cover = steps ? CoverSums(tree_, cover, *steps, kernels_) : CoverSums(tree_, cover, box, kernels_);
  SampleBox part = samples;
  for (part.begin[1] = samples.begin[1]; part.begin[1] < samples.end[1]; part.begin[1] = part.end[1]) {
    part.end[1] = std::min(part.begin[1] + kRow, samples.end[1]);
    for (part.begin[0] = samples.begin[0]; part.begin[0] < samples.end[0]; part.begin[0] = part.end[0]) {
      part.end[0] = std::min(part.begin[0] + kRow, samples.end[0]);
      // Where rows would leave half of their lanes idle, samples are taken as they come.
      part.side(0) <= kRow / 2 ? add_one_by_one(of_cover, part, sums) : add_in_rows(of_cover, part, sums);
    }
  }
}

void LatticeCovers::add_in_rows(CoverSums& cover, const SampleBox& samples, const BoxSums& sums) const {
  SampleTile tile;
  for (std::size_t y = samples.begin[1]; y < samples.end[1]; ++y) {
    for (std::size_t i = 0; i < kRow; ++i) {
      tile.add({axes_[0][std::min(samples.begin[0] + i, samples.end[0] - 1)], axes_[1][y], axes_[2][samples.begin[2]]});
    }
  }
  for (std::size_t z = samples.begin[2]; z < samples.end[2]; ++z) {
    tile.z.fill(axes_[2][z]);
    cover.evaluate(tile, TileShape::kInRows, [&](std::size_t n, double turns, double rest) {
      if (n % kRow >= samples.side(0)) return;  // an idle lane
      double& sum = sums.numbers[sums.place(samples.begin[0] + n % kRow, samples.begin[1] + n / kRow, z)];
      sum = turns + (rest + sum);
    });
  }
}

void LatticeCovers::add_one_by_one(CoverSums& cover, const SampleBox& samples, const BoxSums& sums) const {
  SampleTile tile;
  std::array<std::size_t, kTile> places;  // among the sums
  const auto evaluate = [&] {
    cover.evaluate(tile, TileShape::kScattered, [&](std::size_t n, double turns, double rest) {
      double& sum = sums.numbers[places[n]];
      sum = turns + (rest + sum);
    });
    tile.clear();
  };
  for (std::size_t z = samples.begin[2]; z < samples.end[2]; ++z) {
    for (std::size_t y = samples.begin[1]; y < samples.end[1]; ++y) {
      for (std::size_t x = samples.begin[0]; x < samples.end[0]; ++x) {
        places[tile.count] = sums.place(x, y, z);
        tile.add({axes_[0][x], axes_[1][y], axes_[2][z]});
        if (tile.count == kTile) evaluate();
      }
    }
  }
  if (tile.count > 0) evaluate();
}

// Those of the rays of samples with triangles, which what their boundary adds wants in addition.
void LatticeCovers::add_crossings(std::span<const std::uint32_t> triangles, const SampleBox& samples,
                                  const BoxSums& sums) const {
  const auto along = [&](std::size_t axis) {
    return std::span(axes_[axis]).subspan(samples.begin[axis], samples.side(axis));
  };
  const auto range = [&](std::size_t axis, const Box& box) {  // of samples in the box's extent
    const auto lower = std::ranges::lower_bound(along(axis), box.lower[static_cast<int>(axis)]);
    const auto upper = std::ranges::upper_bound(along(axis), box.upper[static_cast<int>(axis)]);
    return std::pair(samples.begin[axis] + static_cast<std::size_t>(lower - along(axis).begin()),
                     samples.begin[axis] + static_cast<std::size_t>(upper - along(axis).begin()));
  };
  const std::span xs = along(0);
  for (const std::uint32_t n : triangles) {
    const SolidTriangle& t = tree_.triangles()[n];
    const Box box = box_of(t.a, t.b, t.c);
    if (box.upper.x < xs.front()) continue;
    const auto [y_begin, y_end] = range(1, box);
    const auto [z_begin, z_end] = range(2, box);
    if (y_begin >= y_end || z_begin >= z_end) continue;
    const TrianglePlane plane(t.a, t.b, t.c);
    for (std::size_t z = z_begin; z < z_end; ++z) {
      for (std::size_t y = y_begin; y < y_end; ++y) {
        const TriangleCrossing crossing = triangle_crossing(t.a, t.b, t.c, {axes_[1][y], axes_[2][z], xs}, &plane);
        const double turns = t.orientation * crossing.sigma;
        double* const row = &sums.numbers[sums.place(samples.begin[0], y, z)];
        for (std::size_t i = 0; i < crossing.crossed; ++i) row[i] += turns;
      }
    }
  }
}

}  // namespace raycone
