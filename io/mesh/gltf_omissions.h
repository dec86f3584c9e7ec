// What a reader of glTF leaves out.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/warning.h"

namespace raycone {

struct GltfOmissions {
  std::uint64_t incomplete_faces = 0;
  std::uint64_t points_or_lines = 0;
  std::uint64_t without_positions = 0;
  std::uint64_t skinned = 0;
  std::uint64_t morphed = 0;
  std::uint64_t without_nodes = 0;
};

// One for each kind.
[[nodiscard]] std::vector<Warning> warnings_of(const GltfOmissions& omissions);

}  // namespace raycone
