#include "core/evaluation/lattice_far.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/boundary/edge_time.h"
#include "core/data/sample_box.h"
#include "core/evaluation/costs.h"
#include "core/evaluation/lattice_tile.h"

namespace raycone {
namespace {

// An estimate of blocks is 0.8 to 1.35 times what they take, that of the far field no better than this.
constexpr double kSafetyOfBlocks = 1.03;
constexpr double kSafety = 0.92;
// An estimate needs the tree, which takes some hundredths of the time of the direct sum at so many samples, where that
// takes so long.
constexpr double kLeastSamples = 1e5;
constexpr double kLeastCost = 4e7;
// Where a lattice is smaller than this, soups and so many exterior edges are left to the far field: a second tree would
// take a twentieth of the time.
constexpr double kSmallLattice = 2e5;  // samples
constexpr std::uint64_t kManyForSmall = 5000;

double cost_in_blocks(const ScaledMesh& mesh, const LatticeAxes& axes) {
  return kBlocksOnLattice.in_blocks * mesh.blocks().sums.cost(axes);
}

double far_field_cost(const ScaledMesh& mesh) { return kFarFieldCost * mesh.far_field()->cost_on_lattice(); }

// Whether it is worth looking at what blocks would take.
bool blocks_may_pay(const ScaledMesh& mesh, const Lattice& lattice) {
  constexpr std::int64_t kMostAlong = 1 << 20;  // samples
  constexpr std::int64_t kLeastAlong = 8;
  const Summation summation = mesh.options().summation;
  if (summation != Summation::kCheapest && summation != Summation::kBlocks) return false;
  if (!mesh.choice().has_blocks()) return false;
  for (const std::int64_t count : lattice.counts) {
    if (count > kMostAlong || count < kLeastAlong) return false;
  }
  const double samples = lattice.samples();
  if (summation == Summation::kBlocks) return true;
  const bool left_to_far_field =
      samples < kSmallLattice && (!mesh.counts_crossings() || mesh.boundary().exterior_edges() >= kManyForSmall);
  return samples >= kLeastSamples && mesh.choice().direct_cost() * samples >= kLeastCost && !left_to_far_field;
}

}  // namespace

std::optional<LatticeAxes> axes_for_blocks(const ScaledMesh& mesh, const Lattice& lattice) {
  if (!blocks_may_pay(mesh, lattice)) return std::nullopt;
  LatticeAxes axes;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (std::int64_t i = lattice.index_min[a]; i <= lattice.index_max(axis); ++i) {
      const double x = lattice.coordinate(axis, i);
      if (!mesh.can_take(x)) return std::nullopt;
      axes[a].push_back(mesh.to_scale(x));
    }
  }
  if (!mesh.blocks().are_sound) return std::nullopt;
  if (mesh.options().summation == Summation::kBlocks) return axes;
  const double samples = lattice.samples(), direct = mesh.choice().direct_cost();
  const bool far = takes_far_field_on_lattice(mesh);
  const double other = far ? std::min(direct, far_field_cost(mesh)) : direct;
  // The tree is there by now.
  const double blocks = cost_in_blocks(mesh, axes) + kBlocksOnLattice.beside_blocks;
  if (blocks * samples + kBlocksOnLattice.fit > kSafetyOfBlocks * other * samples) return std::nullopt;
  return axes;
}

bool takes_far_field_on_lattice(const ScaledMesh& mesh) {
  // Exterior edges, of which the tree saves too little; on small lattices, where it takes a twentieth of the time.
  constexpr std::uint64_t kTooFewAnywhere = 200;
  const bool forced = mesh.options().summation == Summation::kFarField;
  if (forced || !mesh.counts_crossings()) return mesh.has_far_field();
  const std::uint64_t edges = mesh.boundary().exterior_edges();
  const bool is_small = mesh.options().accuracy.samples < kSmallLattice;
  return edges >= (is_small ? kManyForSmall : kTooFewAnywhere) && mesh.has_far_field() &&
         mesh.far_field()->cost_on_lattice() < kSafety * static_cast<double>(edges);
}

// The constants of both are seconds on an AMD EPYC (Zen 4). Those of samples matter where edges are few.
double direct_boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice) {
  constexpr double kSample = 1.2e-8;  // beside its edges
  if (mesh.is_closed()) return 0.0;
  return (kSample + edge_seconds(mesh.options().level) * mesh.choice().direct_cost()) * lattice.samples();
}

double boundary_seconds(const ScaledMesh& mesh, const Lattice& lattice) {
  constexpr double kSampleOfBlocks = 1.0e-8;  // beside what its block sums
  constexpr double kSource = 1e-5;            // in the tree
  if (mesh.is_closed()) return 0.0;
  const double edge = edge_seconds(mesh.options().level), samples = lattice.samples();
  if (const std::optional<LatticeAxes> axes = axes_for_blocks(mesh, lattice)) {
    const double once = kBlocksOnLattice.fit + kBlocksOnLattice.tree * mesh.choice().direct_cost();
    return kSampleOfBlocks * samples + edge * (cost_in_blocks(mesh, *axes) * samples + once);
  }
  if (takes_far_field_on_lattice(mesh)) {
    const auto sources = static_cast<double>(mesh.far_field()->sources().triangles().size());
    return edge * far_field_cost(mesh) * samples + kSource * sources;
  }
  return direct_boundary_seconds(mesh, lattice);
}

namespace {

// What a block's sums become.
class BlockValues {
 public:
  BlockValues(const ScaledMesh& mesh, const LatticeAxes& axes)
      : mesh_(mesh), axes_(axes), doubt_(mesh.choice().doubt_of_blocks()) {}

  // Sets the values of samples of a row from `sample` on, all with the same crossings, less those of the caps.
  void set(const std::array<std::size_t, 3>& sample, std::span<const double> sums, double crossings,
           double cap_crossings, std::span<double> values) const {
    const double whole = crossings - cap_crossings;
    int doubtful = 0;  // no least distance, whose comparisons compilers do not put into lanes
    for (std::size_t i = 0; i < sums.size(); ++i) {
      values[i] = whole + sums[i];
      doubtful |= static_cast<int>(!(distance_to_half_integer(values[i]) > doubt_));  // or NaN
    }
    if (doubtful != 0) sum_doubtful(values, sample, static_cast<std::int64_t>(crossings));
  }

 private:
  void sum_doubtful(std::span<double> values, const std::array<std::size_t, 3>& sample, std::int64_t crossings) const {
    LatticeTile tile(mesh_, SetValue{values}, LatticeTile<SetValue>::Sum::kDirect);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (distance_to_half_integer(values[i]) > doubt_) continue;
      tile.add(i, {axes_[0][sample[0] + i], axes_[1][sample[1]], axes_[2][sample[2]]}, crossings);
    }
    tile.evaluate();
  }

  const ScaledMesh& mesh_;
  const LatticeAxes& axes_;
  double doubt_;
};

}  // namespace

void evaluate_blocks(const ScaledRows& part, const LatticeAxes& axes,
                     const std::function<CrossingsOfRow(std::size_t row)>& crossings, std::span<double> values,
                     std::atomic<std::uint64_t>* done) {
  const ScaledMesh& mesh = part.mesh;
  SampleBox box;  // the part, by indices in the whole lattice
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = static_cast<std::size_t>(part.block.first[a] - part.lattice.index_min[a]);
    box.end[a] = box.begin[a] + static_cast<std::size_t>(part.block.counts[a]);
  }
  const BlockValues of_block(mesh, axes);
  mesh.blocks().sums.for_each_row(
      axes, box, [&](std::size_t x, std::size_t y, std::size_t z, std::span<const double> sums) {
        const std::size_t row = (z - box.begin[2]) * box.side(1) + y - box.begin[1];
        const std::size_t in_row = x - box.begin[0];
        const std::span<double> of_row = values.subspan(row * box.side(0), box.side(0));
        const auto set = [&](std::size_t begin, std::size_t end, double n, double caps) {
          of_block.set({box.begin[0] + begin, y, z}, sums.subspan(begin - in_row, end - begin), n, caps,
                       of_row.subspan(begin, end - begin));
          return true;
        };
        const std::size_t end_in_row = in_row + sums.size();
        if (mesh.counts_crossings()) {
          const CrossingsOfRow n_of_row = crossings(row);
          n_of_row.mesh.for_each(in_row, end_in_row, [&](std::size_t begin, std::size_t end, double n) {
            return n_of_row.caps.for_each(
                begin, end, [&](std::size_t from, std::size_t to, double caps) { return set(from, to, n, caps); });
          });
        } else {
          set(in_row, end_in_row, 0.0, 0.0);
        }
        if (done) done->fetch_add(sums.size(), std::memory_order_relaxed);
      });
}

}  // namespace raycone
