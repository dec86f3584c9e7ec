#include "core/evaluation/rows.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/evaluation/block_parts.h"
#include "core/evaluation/lattice_far.h"
#include "core/evaluation/lattice_tile.h"
#include "core/evaluation/row_crossings.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// --- What the boundary adds -----------------------------------------------------------------------------------------

// Of a sample whose crossings are its value so far, where they are counted.
std::int64_t crossings_at(const ScaledMesh& mesh, std::span<const double> values, std::size_t index) {
  return mesh.counts_crossings() ? static_cast<std::int64_t>(values[index]) : 0;
}

// Turns crossings of the rows [begin, end) into winding numbers, by the direct sum.
void add_boundary_term(const ScaledMesh& mesh, const LatticeRows& rows, std::size_t begin, std::size_t end,
                       std::span<double> values) {
  const std::size_t samples = rows.xs.size();
  RowTiles tiles(mesh, SetValue{values}, LatticeTile<SetValue>::Sum::kDirect);
  for (std::size_t number = begin; number < end; ++number) {
    const Row row = rows.row(number);
    tiles.begin_row(samples);
    for (std::size_t n = number * samples, i = 0; i < samples; ++i, ++n) {
      tiles.add(n, row.query(i), crossings_at(mesh, values, n));
    }
  }
  tiles.finish();
}

// Of the rows [begin, end). Precondition: diagnostics are asked for.
void bound_errors(const ScaledMesh& mesh, const LatticeRows& rows, std::size_t begin, std::size_t end,
                  const ValueOutputs& out) {
  const std::size_t samples = rows.xs.size(), last = end * samples;
  SampleTile tile;
  for (std::size_t first = begin * samples; first < last; first += kTile) {
    const std::size_t count = std::min(kTile, last - first);
    tile.clear();
    for (std::size_t n = first; n < first + count; ++n) tile.add(rows.row(n / samples).query(n % samples));
    mesh.bound_errors(tile, out.values.subspan(first, count), out.diagnostics->crossings.subspan(first, count),
                      out.diagnostics->error_bound.subspan(first, count));
  }
}

void bound_all_errors(const ScaledMesh& mesh, const LatticeRows& rows, const ValueOutputs& out) {
  parallel_for_each(rows.size(), [&](std::size_t row) {
    bound_errors(mesh, rows, row, row + 1, out);
    out.count_done(rows.xs.size());
  });
}

// In bricks of neighbours: nodes that are far from one sample are mostly far from all.
constexpr std::size_t kBrick = 4;  // samples along each side

// To the samples of the rows (j, k) of two ranges, each up to before its second number.
void add_far_field(const ScaledMesh& mesh, const LatticeRows& rows, std::array<std::size_t, 2> j_range,
                   std::array<std::size_t, 2> k_range, std::span<double> values) {
  const std::size_t nx = rows.xs.size(), ny = rows.ys.size();
  LatticeTile tile(mesh, SetValue{values});
  const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
    const std::size_t n = (k * ny + j) * nx + i;
    tile.add(n, {rows.xs[i], rows.ys[j], rows.zs[k]}, crossings_at(mesh, values, n));
  };
  for (std::size_t i = 0; i < nx; i += kBrick) {
    // Eight samples of a cube follow one another, in one group of lanes.
    for (std::size_t corner = 0; corner < kBrick * kBrick * kBrick; corner += 8) {
      const std::size_t half = corner / 8;
      for (std::size_t n = 0; n < 8; ++n) {
        const std::size_t x = i + 2 * (half & 1) + (n & 1), y = j_range[0] + (half & 2) + (n >> 1 & 1);
        const std::size_t z = k_range[0] + (half >> 1 & 2) + (n >> 2);
        if (x < nx && y < j_range[1] && z < k_range[1]) add(x, y, z);
      }
    }
  }
  tile.evaluate();
}

void add_far_field(const ScaledMesh& mesh, const LatticeRows& rows, const ValueOutputs& out) {
  const std::size_t ny = rows.ys.size(), nz = rows.zs.size(), across = (ny + kBrick - 1) / kBrick;
  parallel_for_each(across * ((nz + kBrick - 1) / kBrick), [&](std::size_t n) {
    const std::size_t j = n % across * kBrick, k = n / across * kBrick;
    const std::array j_range{j, std::min(j + kBrick, ny)}, k_range{k, std::min(k + kBrick, nz)};
    add_far_field(mesh, rows, j_range, k_range, out.values);
    for (std::size_t row = k_range[0]; out.diagnostics && row < k_range[1]; ++row) {
      bound_errors(mesh, rows, row * ny + j_range[0], row * ny + j_range[1], out);
    }
    out.count_done((j_range[1] - j) * (k_range[1] - k) * rows.xs.size());
  });
}

// --- The whole ------------------------------------------------------------------------------------------------------

// Sets the values of rows whose crossings are known, by the direct sum. Returns how many samples lie on the surface.
std::uint64_t finish_rows(const ScaledMesh& mesh, const LatticeRows& rows, LatticeSums& sums, const ValueOutputs& out) {
  std::atomic<std::uint64_t> on_surface = 0;
  const std::size_t rows_per_task = std::max<std::size_t>(1, 4 * kTile / rows.xs.size());
  parallel_for(rows.size(), rows_per_task, [&](std::size_t first, std::size_t last) {
    std::uint64_t here = 0;
    for (std::size_t begin = first; begin < last; begin += rows_per_task) {
      const std::size_t end = std::min(begin + rows_per_task, last);
      for (std::size_t row = begin; row < end; ++row) here += sums.finish(row);
      if (!mesh.is_closed()) add_boundary_term(mesh, rows, begin, end, out.values);
      if (out.diagnostics) bound_errors(mesh, rows, begin, end, out);
      out.count_done((end - begin) * rows.xs.size());
    }
    on_surface += here;
  });
  return on_surface;
}

// Of a block that the scaled mesh can take, by blocks of samples.
Tally evaluate_part_by_blocks(const ScaledRows& part, const LatticeAxes& axes, const ValueOutputs& out) {
  const ScaledMesh& mesh = part.mesh;
  const LatticeRows& rows = part.rows;
  const std::size_t samples = rows.xs.size();
  // Diagnostics take the crossings of each sample, and leave them in its value.
  LatticeSums sums = out.diagnostics           ? LatticeSums(rows.size(), samples, out.values, out.diagnostics)
                     : mesh.counts_crossings() ? LatticeSums(rows.size(), samples)
                                               : LatticeSums(rows.size(), samples, {}, nullptr);
  collect_crossings(part, sums);
  const std::uint64_t on_surface = finish_all(rows, sums);
  LatticeSums of_caps(rows.size(), samples, LatticeSums::OnSurface::kIgnore);
  sum_crossings(mesh.caps().mesh, rows, of_caps);
  const auto crossings_of_row = [&](std::size_t row) -> CrossingsOfRow {
    const std::span<const double> each = out.values.subspan(row * samples, samples);
    return {out.diagnostics ? RowRuns(each) : sums.runs(row), of_caps.runs(row)};
  };
  // Bounds take a hundred times as long as values: a sample is done when it has its own.
  evaluate_blocks(part, axes, crossings_of_row, out.values, out.diagnostics ? nullptr : out.done);
  if (out.diagnostics) bound_all_errors(mesh, rows, out);
  return {sums.ties(), on_surface};
}

// Of a block whose coordinates along each axis the scaled mesh can take all, or none of.
Tally evaluate_part(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block,
                    const ValueOutputs& out) {
  const ScaledRows part = scaled_rows(meshes, lattice, block);
  const ScaledMesh& mesh = part.mesh;
  const LatticeRows& rows = part.rows;
  const bool scaled = &mesh == &meshes.scaled();
  if (const std::optional<LatticeAxes> axes = scaled ? axes_for_blocks(mesh, lattice) : std::nullopt) {
    return evaluate_part_by_blocks(part, *axes, out);
  }
  const bool counts = mesh.counts_crossings() || out.diagnostics;
  LatticeSums sums(rows.size(), rows.xs.size(), counts ? out.values : std::span<double>(), out.diagnostics);
  collect_crossings(part, sums);
  if (!takes_far_field_on_lattice(mesh)) {
    const std::uint64_t on_surface = finish_rows(mesh, rows, sums, out);
    return {sums.ties(), on_surface};
  }
  const std::uint64_t on_surface = finish_all(rows, sums);
  add_far_field(mesh, rows, out);
  return {sums.ties(), on_surface};
}

}  // namespace

Tally evaluate_block(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block,
                     const ValueOutputs& out) {
  const std::vector<LatticeBlock> parts =
      parts_alike(lattice, block, [&](double x) { return meshes.scaled().can_take(x); });
  if (parts.size() == 1) return evaluate_part(meshes, lattice, block, out);
  Tally tally;
  for (const LatticeBlock& part : parts) {
    PartSamples samples(static_cast<std::size_t>(part.size()), out.diagnostics != nullptr);
    const Diagnostics* part_diagnostics = out.diagnostics ? &samples.diagnostics() : nullptr;
    tally += evaluate_part(meshes, lattice, part, {samples.values(), out.done, part_diagnostics});
    samples.copy_to(block, part, out.values, out.diagnostics);
  }
  return tally;
}

}  // namespace raycone
