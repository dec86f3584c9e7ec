#include "core/evaluation/row_crossings.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/crossings/lattice_scan.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// By Embree, which looks at one row at a time.
void cast_rays(const ScaledMesh& mesh, const LatticeRows& rows, LatticeSums& sums) {
  parallel_for(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
    LatticeSums::Collector collector(sums);
    std::vector<std::uint32_t> candidates;
    for (std::size_t number = begin; number < end; ++number) {
      const Row row = rows.row(number);
      mesh.rays().find_candidates(row.query(0), candidates);
      for (const std::uint32_t triangle : candidates) {
        const auto [a, b, c] = corners_of(mesh.mesh(), mesh.mesh().triangles[triangle]);
        collector.add(number, triangle_crossing(a, b, c, row));
      }
    }
    collector.finish();
  });
}

// The order of the triangles along the axis across which the block is a thin slab of the lattice, if it is.
std::optional<OrderedSlab> ordered_slab(const ScaledMesh& mesh, const Lattice& lattice, const LatticeBlock& block) {
  constexpr std::int64_t kWorthSorting = 4;  // slabs
  for (const int axis : {2, 1}) {
    const auto a = static_cast<std::size_t>(axis);
    if (block.counts[a] <= lattice.counts[a] / kWorthSorting) return OrderedSlab{mesh.slab_order(axis), axis};
  }
  return std::nullopt;
}

}  // namespace

ScaledRows scaled_rows(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block) {
  const auto first = [&](int axis) { return lattice.coordinate(axis, block.first[static_cast<std::size_t>(axis)]); };
  const ScaledMesh& mesh = meshes.of_query(meshes.scaled().can_take(Vec3{first(0), first(1), first(2)}));
  return {lattice, block, mesh, rows_in_scale(lattice, block, [&](double x) { return mesh.to_scale(x); })};
}

void collect_crossings(const ScaledRows& part, LatticeSums& sums) {
  const ScaledMesh& mesh = part.mesh;
  if (mesh.options().ray_engine != RayEngine::kEmbree) {
    scan_triangles(mesh.mesh(), part.rows, ordered_slab(mesh, part.lattice, part.block), sums);
  } else {
    (void)mesh.rays();  // not within the loop over rows, whose threads would wait for one another
    cast_rays(mesh, part.rows, sums);
  }
  sums.arrange();
}

std::uint64_t finish_all(const LatticeRows& rows, LatticeSums& sums) {
  std::atomic<std::uint64_t> on_surface = 0;
  parallel_for(rows.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    std::uint64_t here = 0;
    for (std::size_t row = begin; row < end; ++row) here += sums.finish(row);
    on_surface.fetch_add(here, std::memory_order_relaxed);
  });
  return on_surface;
}

void sum_crossings(const TriangleMesh& caps, const LatticeRows& rows, LatticeSums& sums) {
  scan_triangles(caps, rows, std::nullopt, sums);
  sums.arrange();
  finish_all(rows, sums);
}

}  // namespace raycone
