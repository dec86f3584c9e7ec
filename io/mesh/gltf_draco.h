// Meshes compressed by Draco, as KHR_draco_mesh_compression embeds them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/vec3.h"

namespace raycone {

struct DracoMesh {
  std::vector<Vec3> vertices;          // the numbers as they are stored
  std::vector<std::uint32_t> corners;  // three of each face, not checked
};

// The faces, and of all points the attribute of unique id `positions`, whose numbers must be of glTF's type 5120 ...
// 5126. Memory is bounded by the number of bytes. Throws InputError "PLACE...", LimitError.
[[nodiscard]] DracoMesh decode_draco(std::string_view bytes, int positions, int component_type,
                                     const std::string& place);

}  // namespace raycone
