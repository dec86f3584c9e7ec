#include "core/evaluation/lattice_far.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "core/evaluation/lattice_tile.h"

namespace raycone {
namespace {

// Times at a sample, in units of that of one of the blocks' triangles: of an exterior edge, and of a triangle among
// all.
constexpr double kEdge = 0.4;
constexpr double kTriangle = 0.75;
// Of what is made once: the fit; of each triangle, its part of the tree.
constexpr double kFit = 4e6;
constexpr double kInTree = 4e2;
// An estimate needs the tree, which takes some hundredths of the time of the direct sum at so many samples.
constexpr double kLeastSamples = 4e5;

double direct_cost(const ScaledMesh& mesh) {
  return mesh.counts_crossings() ? kEdge * static_cast<double>(mesh.boundary().exterior_edges())
                                 : kTriangle * static_cast<double>(mesh.mesh().triangles.size());
}

double once_cost(const ScaledMesh& mesh) { return kFit + kInTree * direct_cost(mesh); }

double gap_to_half_integer(double w) { return 0.5 - std::abs(w - ((w + 0x1.8p52) - 0x1.8p52)); }

}  // namespace

std::optional<LatticeAxes> axes_for_blocks(const ScaledMesh& mesh, const Lattice& lattice) {
  constexpr std::int64_t kMostAlong = 1 << 20;  // samples
  constexpr std::int64_t kLeastAlong = 8;
  if (!mesh.has_blocks()) return std::nullopt;
  double samples = 1.0;
  for (const std::int64_t count : lattice.counts) {
    if (count > kMostAlong || count < kLeastAlong) return std::nullopt;
    samples *= static_cast<double>(count);
  }
  const bool forced = mesh.options().summation == Summation::kBlocks;
  const double direct = direct_cost(mesh);
  if (!forced && (samples < kLeastSamples || direct * samples < 2 * kFit)) return std::nullopt;
  LatticeAxes axes;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (std::int64_t i = lattice.index_min[a]; i <= lattice.index_max(axis); ++i) {
      const double x = lattice.coordinate(axis, i);
      if (!mesh.can_take(x)) return std::nullopt;
      axes[a].push_back(mesh.to_scale(x));
    }
  }
  constexpr double kSafety = 0.75;  // estimates are no better
  if (!mesh.blocks().are_sound) return std::nullopt;
  if (forced) return axes;
  if (mesh.blocks().sums.cost(axes) * samples + once_cost(mesh) > kSafety * direct * samples) return std::nullopt;
  return axes;
}

double boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice, bool by_far_field) {
  constexpr double kUnit = 5.2e-9;    // of a direct sum
  constexpr double kInBlocks = 9e-9;  // of blocks, with all that they take beside triangles; of five meshes at 256
  constexpr double kSource = 1e-5;    // in the tree
  if (mesh.is_closed()) return 0.0;
  double samples = 1.0;
  for (const std::int64_t count : lattice.counts) samples *= static_cast<double>(count);
  if (!by_far_field) return kUnit * direct_cost(mesh) * samples;
  if (const std::optional<LatticeAxes> axes = axes_for_blocks(mesh, lattice)) {
    return kInBlocks * (mesh.blocks().sums.cost(*axes) * samples + once_cost(mesh));
  }
  if (mesh.has_far_field()) {
    const FarField* const far = mesh.far_field();
    return kUnit * kEdge * far->cost() * samples + kSource * static_cast<double>(far->sources().triangles().size());
  }
  return kUnit * direct_cost(mesh) * samples;
}

void evaluate_blocks(const ScaledMesh& mesh, const LatticeAxes& axes, const Lattice& lattice, const LatticeBlock& block,
                     std::span<double> values, std::span<const double> cap_crossings,
                     std::atomic<std::uint64_t>* done) {
  std::array<SampleRange, 3> part;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto begin = static_cast<std::uint32_t>(block.first[a] - lattice.index_min[a]);
    part[a] = {begin, begin + static_cast<std::uint32_t>(block.counts[a])};
  }
  const bool counts = mesh.counts_crossings();
  const double doubt = mesh.doubt_of_blocks();
  mesh.blocks().sums.for_each_row(
      axes, part, [&](std::size_t x, std::size_t y, std::size_t z, std::span<const double> sums) {
        const std::size_t row = (z - part[2].begin) * part[1].size() + y - part[1].begin;
        const std::size_t first = row * part[0].size() + x - part[0].begin;
        LatticeTile doubtful(mesh, SetValue{values}, LatticeTile<SetValue>::Sum::kDirect);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          const std::size_t n = first + i;
          const double w = (counts ? values[n] - cap_crossings[n] : 0.0) + sums[i];
          if (gap_to_half_integer(w) > doubt) {
            values[n] = w;
            continue;
          }
          doubtful.add(n, {axes[0][x + i], axes[1][y], axes[2][z]}, counts ? static_cast<std::int64_t>(values[n]) : 0);
        }
        doubtful.evaluate();
        if (done) done->fetch_add(sums.size(), std::memory_order_relaxed);
      });
}

}  // namespace raycone
