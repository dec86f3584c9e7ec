// Which mesh is read, and what is done to it before it is evaluated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh/normalize.h"
#include "core/mesh/weld.h"
#include "core/orientation/orient.h"
#include "io/mesh/read_mesh.h"

namespace raycone {

// What the parts are that labels tell apart.
enum class PartsBy {
  kFile,       // each mesh is one
  kGroup,      // what the file names: groups and objects of OBJ, solids of STL, meshes of glTF, objects of 3MF
  kComponent,  // faces that are joined through vertices
};

// Which part gives its label to what several of them have.
enum class PartPriority { kLast, kFirst };

struct PartsOptions {
  PartsBy by = PartsBy::kFile;
  PartPriority priority = PartPriority::kLast;
};

struct MeshOptions {
  std::string path;  // "-": standard input; on the command line also @LIST
  ReadMeshOptions reading;
  Weld weld;
  Orient orient = Orient::kKeep;
  std::optional<Normalize> normalize;  // after scaling, before welding
  std::vector<std::string> further;    // meshes behind the first; for labels only
  PartsOptions parts;
  std::vector<std::string> lists;  // of which meshes were read, once they have been
};

}  // namespace raycone
