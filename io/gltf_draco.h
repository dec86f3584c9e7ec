// Meshes compressed by Draco, as KHR_draco_mesh_compression embeds them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/triangle_mesh.h"

namespace raycone {

struct DracoPositions {
  int attribute = 0;       // its unique id
  int component_type = 0;  // glTF's 5120 ... 5126, which that of the data must equal
};

// The faces of all points, and the numbers of one attribute as they are stored, of three components. Indices of faces
// are not checked. Memory is bounded by the number of bytes. Throws InputError "PLACE...", LimitError.
[[nodiscard]] TriangleMesh decode_draco(std::string_view bytes, const DracoPositions& positions,
                                        const std::string& place);

}  // namespace raycone
