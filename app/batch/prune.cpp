#include "app/batch/prune.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <set>
#include <system_error>

namespace raycone {
namespace {

bool path_is_missing(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) != 0 && (errno == ENOENT || errno == ENOTDIR);
}

// A directory is no mesh: of rows about one the names end with a slash.
bool is_gone(const std::string& name, const std::string& path) {
  std::error_code error;
  const bool became_directory = !name.ends_with('/') && std::filesystem::is_directory(path, error);
  return became_directory || path_is_missing(path);
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
    if (path.empty() ? all_seen : is_gone(name, path)) gone.emplace(name, path.empty() ? name : path);
  }
  return gone;
}

}  // namespace raycone
