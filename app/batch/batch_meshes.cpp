#include "app/batch/batch_meshes.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/process/usage_error.h"
#include "io/files/read_file.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Device and inode.
using DirectoryIdentity = std::pair<dev_t, ino_t>;

bool has_mesh_extension(const fs::path& path) {
  const std::string extension = path.extension().string();
  return !extension.empty() && mesh_format_from_name(std::string_view(extension).substr(1)).has_value();
}

// What a directory holds that may be a mesh, by names relative to it.
class DirectorySearch {
 public:
  explicit DirectorySearch(std::string root) : root_(std::move(root)) {}

  std::vector<BatchMesh> meshes() && {
    visit_directory("");
    return std::move(meshes_);
  }

 private:
  // `name`: relative to the root, ending with a slash unless empty.
  void visit_directory(const std::string& name) {
    struct stat status {};
    const std::string path = path_of(name);
    if (stat(path.c_str(), &status) != 0) return add(name);
    const DirectoryIdentity identity{status.st_dev, status.st_ino};
    if (std::ranges::count(ancestors_, identity) > 0) return;  // a link to a directory above
    std::error_code error;
    fs::directory_iterator entries(path, error);
    if (error) return add(name);
    ancestors_.push_back(identity);
    for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
      visit(*entries, name + entries->path().filename().string());
    }
    if (error) add(name);
    ancestors_.pop_back();
  }

  void visit(const fs::directory_entry& entry, const std::string& name) {
    std::error_code error;
    const fs::file_status status = entry.status(error);
    if (fs::is_directory(status)) return visit_directory(name + '/');
    // A dangling link is a mesh that is missing; devices and pipes are none.
    if (has_mesh_extension(entry.path()) && !fs::is_other(status)) add(name);
  }

  [[nodiscard]] std::string path_of(const std::string& name) const {
    return root_ + (root_.ends_with('/') || name.empty() ? "" : "/") + name;
  }

  void add(const std::string& name) {
    meshes_.push_back({path_of(name), name.empty() ? "./" : name, "", stamp_of(path_of(name))});
  }

  std::string root_;
  std::vector<DirectoryIdentity> ancestors_;
  std::vector<BatchMesh> meshes_;
};

// A file or directory on the command line or in a list.
void add_path(const std::string& path, std::vector<BatchMesh>& meshes) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    std::vector<BatchMesh> found = DirectorySearch(path).meshes();
    meshes.insert(meshes.end(), found.begin(), found.end());
  } else {
    meshes.push_back({path, fs::path(path).filename().string(), "", stamp_of(path)});
  }
}

void add_list(const std::string& list, char separator, std::vector<BatchMesh>& meshes) {
  const std::string text = read_file(list);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    std::string path = text.substr(begin, end - begin);
    if (separator == '\n' && path.ends_with('\r')) path.pop_back();
    if (!path.empty()) add_path(path, meshes);
    begin = end + 1;
  }
}

std::string output_name(const std::string& name, const MeshSearch& search) {
  if (search.full_names) return name + '.' + search.extension;
  return fs::path(name).replace_extension(search.extension).string();
}

// Results are kept by name, outputs by theirs: both must be unique.
void refuse_collisions(const std::vector<BatchMesh>& meshes) {
  std::map<std::string, const BatchMesh*> by_output;
  for (const BatchMesh& mesh : meshes) {
    const auto [other, is_new] = by_output.emplace(mesh.output, &mesh);
    if (is_new) continue;
    const std::string both = other->second->path + " and " + mesh.path;
    if (other->second->name == mesh.name) throw UsageError(both + ": would both be " + mesh.name + " in the results");
    throw UsageError(both + ": would both be written to " + mesh.output + "; --full-names keeps them apart");
  }
}

bool same_file(const BatchMesh& a, const BatchMesh& b) {
  std::error_code error;
  return a.name == b.name && (a.path == b.path || fs::equivalent(a.path, b.path, error));
}

}  // namespace

std::vector<BatchMesh> find_meshes(const MeshSearch& search) {
  std::vector<BatchMesh> meshes;
  for (const std::string& operand : search.operands) {
    if (operand.starts_with('@') || operand == "-") {
      add_list(operand == "-" ? operand : operand.substr(1), search.nul_separated_lists ? '\0' : '\n', meshes);
    } else {
      add_path(operand, meshes);
    }
  }
  std::ranges::stable_sort(meshes, {}, &BatchMesh::name);
  meshes.erase(std::unique(meshes.begin(), meshes.end(), same_file), meshes.end());
  for (BatchMesh& mesh : meshes) mesh.output = output_name(mesh.name, search);
  refuse_collisions(meshes);
  return meshes;
}

}  // namespace raycone
