// From a box and the lattice options to the lattice. The rules are those of docs/formats.md, "Lattices".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/data/lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

struct WorldPadding {
  double width = 0.0;  // world units; widens the box on every side before sampling, negative values narrow it
};
struct VoxelPadding {
  std::int64_t samples = 0;  // added at either end of every axis, beside samples that stay where they are
};

// `count` samples (or, with centers, cells) along the longest side, cubic voxels.
struct LongestSide {
  std::int64_t count = 64;
};
// Exactly these counts, both ends of each side included.
struct SampleCounts {
  std::array<std::int64_t, 3> counts{1, 1, 1};
};
// Samples at the integer multiples of `size` (world units) that cover the box.
struct VoxelSize {
  Vec3 size;
};

struct LatticeRequest {
  std::optional<Box> bounds;  // in place of the mesh's box
  std::variant<WorldPadding, VoxelPadding> padding;
  std::variant<LongestSide, SampleCounts, VoxelSize> sampling;
  bool centers = false;  // samples at the centres of cells, else at their corners
};

// A description of each flat side for which more than one sample was asked is appended to `warnings`. Throws
// UsageError where negative padding leaves nothing, LimitError where double or the indices cannot hold the lattice.
[[nodiscard]] Lattice choose_lattice(const Box& mesh_box, const LatticeRequest& request,
                                     std::vector<std::string>& warnings);

// Throws UsageError where a negative width leaves nothing.
[[nodiscard]] Box widened(Box box, double width);

// Number of samples. Throws LimitError, with the number, where it exceeds 64 bits, or kMaxBlockSide along an axis.
[[nodiscard]] std::uint64_t sample_count(const Lattice& lattice);

}  // namespace raycone
