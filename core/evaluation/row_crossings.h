// What the rays of a block of a lattice cross.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/crossings/lattice_rows.h"
#include "core/crossings/lattice_sums.h"
#include "core/data/lattice.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// Of loops that only finish rows or read what was found of them, some microseconds each.
inline constexpr std::size_t kRowsPerTask = 16;

// A block of a lattice, and its rows in the scale of the mesh that they are evaluated with.
struct ScaledRows {
  const Lattice& lattice;
  const LatticeBlock& block;
  const ScaledMesh& mesh;
  LatticeRows rows;
};

// With the scaled mesh where it can take the block's coordinates, the unscaled one where not: along each axis all or
// none. All of them must stay while the result is used.
[[nodiscard]] ScaledRows scaled_rows(const ScaledMeshes& meshes, const Lattice& lattice, const LatticeBlock& block);

// Collects and arranges the crossings of the rows, by the mesh's ray engine.
void collect_crossings(const ScaledRows& part, LatticeSums& sums);

// Finishes all rows. Returns how many samples lie on the surface.
std::uint64_t finish_all(const LatticeRows& rows, LatticeSums& sums);

// Collects and finishes the crossings of caps.
void sum_crossings(const TriangleMesh& caps, const LatticeRows& rows, LatticeSums& sums);

}  // namespace raycone
