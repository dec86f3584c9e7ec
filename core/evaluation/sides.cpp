#include "core/evaluation/sides.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/evaluation/block_parts.h"
#include "core/evaluation/row_crossings.h"
#include "core/evaluation/rows.h"
#include "core/evaluation/rule_blocks.h"
#include "core/evaluation/side_setter.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Of a closed mesh: crossings are winding numbers.
void set_sides_of_runs(const LatticeRows& rows, const Rule& rule, const LatticeSums& crossings,
                       std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) {
  const std::size_t samples = rows.xs.size();
  parallel_for(rows.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::span<std::uint8_t> of_row = sides.subspan(row * samples, samples);
      crossings.runs(row).for_each(0, samples, [&](std::size_t first, std::size_t last, double n) {
        std::ranges::fill(of_row.subspan(first, last - first), static_cast<std::uint8_t>(holds(rule, n)));
        return true;
      });
    }
    if (done) done->fetch_add((end - begin) * samples, std::memory_order_relaxed);
  });
}

// Where certificates do not pay: from the winding number of each sample.
Tally sides_by_values(const ScaledMeshes& meshes, const ScaledRows& part, const Rule& rule,
                      std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) {
  const LatticeRows& rows = part.rows;
  std::vector<double> values(sides.size());
  const Tally tally = evaluate_block(meshes, part.lattice, part.block, {values, done});
  const MeshRule mesh_rule(part.mesh, rule);
  const std::size_t samples = rows.xs.size();
  parallel_for(rows.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    SideSetter setter(mesh_rule, sides);
    for (std::size_t n = begin * samples; n < end * samples; ++n) {
      setter.set(n, rows.row(n / samples).query(n % samples), values[n]);
    }
    setter.finish();
  });
  return tally;
}

// Whether set_sides() does not pay, or may not be called.
bool takes_values(const ScaledMesh& mesh, const LatticeBlock& block) {
  constexpr double kWorthCaps = 0x1p20;  // edges at samples take about as long as caps and their tree
  if (!mesh.is_in_scale()) return true;
  if (!mesh.counts_crossings()) return !mesh.choice().has_rough_sums() || !mesh.blocks().are_sound;
  return static_cast<double>(block.size()) * static_cast<double>(mesh.boundary().exterior_edges()) <= kWorthCaps;
}

// Of a block whose coordinates along each axis the scaled mesh can take all, or none of.
Tally evaluate_part(const ScaledMeshes& meshes, const Rule& rule, const Lattice& lattice, const LatticeBlock& block,
                    std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) {
  const ScaledRows part = scaled_rows(meshes, lattice, block);
  const ScaledMesh& mesh = part.mesh;
  const LatticeRows& rows = part.rows;
  if (!mesh.is_closed() && takes_values(mesh, block)) {
    return sides_by_values(meshes, part, rule, sides, done);
  }
  LatticeSums crossings(rows.size(), rows.xs.size());
  collect_crossings(part, crossings);
  const Tally tally{crossings.ties(), finish_all(rows, crossings)};
  if (mesh.is_closed()) {
    set_sides_of_runs(rows, rule, crossings, sides, done);
    return tally;
  }
  LatticeSums of_caps(rows.size(), rows.xs.size(), LatticeSums::OnSurface::kIgnore);
  sum_crossings(mesh.caps().mesh, rows, of_caps);
  // The triangles of a soup are its caps: nothing is left between them, and it has no others.
  const LatticeSums& of_mesh = mesh.counts_crossings() ? crossings : of_caps;
  set_sides(SideSamples(mesh, rows, rule, of_mesh, of_caps, sides), done);
  return tally;
}

}  // namespace

Tally evaluate_block_sides(const ScaledMeshes& meshes, const Rule& rule, const Lattice& lattice,
                           const LatticeBlock& block, std::span<std::uint8_t> sides, std::atomic<std::uint64_t>* done) {
  const std::vector<LatticeBlock> parts =
      parts_alike(lattice, block, [&](double x) { return meshes.scaled().can_take(x); });
  if (parts.size() == 1) return evaluate_part(meshes, rule, lattice, block, sides, done);
  Tally tally;
  for (const LatticeBlock& part : parts) {
    std::vector<std::uint8_t> of_part(static_cast<std::size_t>(part.size()));
    tally += evaluate_part(meshes, rule, lattice, part, of_part, done);
    copy_part<std::uint8_t>(block, part, of_part, sides);
  }
  return tally;
}

}  // namespace raycone
