// `raycone info` as plain values.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/options/mesh_options.h"
#include "app/options/run_options.h"
#include "io/files/output_file.h"

namespace raycone {

enum class InfoFormat { kText, kJson, kCsv };

// What a mesh may be asked to be (docs/formats.md, "Facts about meshes").
enum class Requirement { kClosed, kOriented, kOutward, kManifold, kEmbedded, kNoDuplicates };

struct InfoCommand {
  std::vector<MeshOptions> meshes;  // or files of values; at least one; they differ in their paths only
  std::string for_meshes;           // one of the options that were given and concern meshes only; empty: none
  RunOptions run;
  InfoFormat format = InfoFormat::kText;
  std::vector<Requirement> required;        // each at most once
  bool intersections = false;               // counted, even where nothing requires it
  std::optional<std::string> mark;          // PLY file of the only mesh with its flaws in colour
  Existing existing = Existing::kReplaced;  // such a file
};

}  // namespace raycone
