#include "io/mesh/gltf_omissions.h"

#include "io/files/counted.h"
#include "io/mesh/mesh_builder.h"

namespace raycone {

std::vector<Warning> warnings_of(const GltfOmissions& omissions) {
  std::vector<Warning> warnings;
  const auto warn = [&](const char* name, std::uint64_t count, const char* noun, const char* what) {
    if (count > 0) warnings.push_back({name, counted(count, noun) + " " + what});
  };
  if (omissions.incomplete_faces > 0) warnings.push_back(skipped_faces_warning(omissions.incomplete_faces));
  warn("points-or-lines", omissions.points_or_lines, "primitive", "of points or lines ignored");
  warn("no-positions", omissions.without_positions, "primitive", "without positions ignored");
  warn("bind-pose", omissions.skinned, "skinned mesh instance", "taken in the bind pose, without its joints");
  warn("morph-targets", omissions.morphed, "morphed mesh instance", "taken without its morph targets");
  warn("no-nodes", omissions.without_nodes, "mesh instance", "taken untransformed, because the file has no nodes");
  return warnings;
}

}  // namespace raycone
