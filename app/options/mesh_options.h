// Which mesh is read, and what is done to it before it is evaluated.
#pragma once

#include <optional>
#include <string>

#include "core/mesh/normalize.h"
#include "core/mesh/weld.h"
#include "core/orientation/orient.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

struct MeshOptions {
  std::string path;  // "-": standard input
  ReadMeshOptions reading;
  Weld weld;
  Orient orient = Orient::kKeep;
  std::optional<Normalize> normalize;  // after scaling, before welding
};

}  // namespace raycone
