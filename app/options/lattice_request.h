// A lattice as it is asked for: its box and its spacing, or the grid that it is taken from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "core/data/box.h"
#include "core/data/vec3.h"

namespace raycone {

struct WorldPadding {
  double width = 0.0;    // world units; widens the box on every side before sampling, negative values narrow it
  bool percent = false;  // of the box's longest side, in place of world units
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

// A grid of an OpenVDB file, its only or first one where the name is empty; or the lattice of an NPZ, NRRD or NIfTI.
struct GridReference {
  std::string path;
  std::string name;
};

}  // namespace raycone
