// Checks of a mesh's distances against their definition, and of lattices against points.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/data/lattice.h"
#include "tests/property/check.h"
#include "tests/support/shapes.h"

namespace raycone::test {

struct DistanceCounts {
  std::uint64_t points = 0;      // compared with exact arithmetic
  std::uint64_t on_surface = 0;  // of these
  std::uint64_t samples = 0;     // of lattices, compared with points, for each band
  std::uint64_t in_band = 0;     // of these
};

// The distance at each finite point is that of exact arithmetic, within 1e-12 of itself or 4 u of the largest
// coordinate of the mesh or the point. Nothing where all holds.
[[nodiscard]] std::optional<Failure> check_distances(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                                                     DistanceCounts& counts);

// For narrow bands and wide ones, each sample is what it is as a point, cut off at the band, to the bit: by the
// evaluator, and by core/distance/distance_band.h at every level of SIMD.
[[nodiscard]] std::optional<Failure> check_lattice_distances(const TriangleMesh& mesh, const Lattice& lattice,
                                                             DistanceCounts& counts);

// Around the mesh or within it, or far larger; often through its vertices.
[[nodiscard]] Lattice any_lattice(const TriangleMesh& mesh, Random& random);

}  // namespace raycone::test
