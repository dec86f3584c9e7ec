#include "app/batch/prune.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <set>

namespace raycone {
namespace {

bool path_is_missing(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) != 0 && (errno == ENOENT || errno == ENOTDIR);
}

}  // namespace

bool is_missing(const BatchMesh& mesh) { return mesh.stamp == FileStamp{} && path_is_missing(mesh.path); }

GoneMeshes gone_meshes(const BatchRecords& records, const std::vector<BatchMesh>& found) {
  std::set<std::string> present;
  for (const BatchMesh& mesh : found) {
    if (!is_missing(mesh)) present.insert(mesh.name);
  }
  const bool all_seen = std::ranges::none_of(present, [](const std::string& name) { return name.ends_with('/'); });
  GoneMeshes gone;
  for (const auto& [name, record] : records) {
    if (present.contains(name)) continue;
    const std::string path = record.origin ? record.origin->path : "";
    if (path.empty() ? all_seen : path_is_missing(path)) gone.emplace(name, path.empty() ? name : path);
  }
  return gone;
}

}  // namespace raycone
