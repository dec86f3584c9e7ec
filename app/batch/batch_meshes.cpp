#include "app/batch/batch_meshes.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/input/mesh_list.h"
#include "app/process/memory_limit.h"
#include "app/process/usage_error.h"
#include "io/files/enumerated.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/unpack.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Device and inode.
using DirectoryIdentity = std::pair<dev_t, ino_t>;

bool has_mesh_extension(const fs::path& path) {
  const std::string extension = fs::path(without_packing_extension(path.string())).extension().string();
  return !extension.empty() && mesh_format_from_name(std::string_view(extension).substr(1)).has_value();
}

// Of what is given by itself: its last component; where that is none of its own (`dir/`, `dir/..`), that of the
// directory meant, with a slash behind it. Never empty.
std::string own_name(const std::string& path) {
  const fs::path name = fs::path(path).filename();
  if (!name.empty() && name != "." && name != "..") return name.string();
  std::error_code error;
  const fs::path directory = (fs::absolute(path, error) / "").lexically_normal();
  return directory.parent_path().filename().string() + '/';
}

// How many meshes this process can keep in mind: links make trees of directories as large as they like.
std::size_t most_meshes() {
  constexpr std::uint64_t kMemoryPerMesh = 1024;  // its names and all that is kept of its result, about
  return static_cast<std::size_t>(available_memory() / kMemoryPerMesh);
}

// What a directory holds that may be a mesh, by names relative to it.
class DirectorySearch {
 public:
  // Throws LimitError when there are more than `most`, or more than kMostDirectories are looked into.
  DirectorySearch(std::string root, std::size_t most) : root_(std::move(root)), most_(most) {}

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
    if (++directories_ > kMostDirectories) refuse(kMostDirectories, " directories");
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
    if (meshes_.size() >= most_) refuse(most_, " meshes for the memory that there is");
    meshes_.push_back({path_of(name), name.empty() ? own_name(path_of("") + '/') : name, "", stamp_of(path_of(name))});
  }

  static constexpr std::size_t kMostDirectories = std::size_t{1} << 20;  // a minute's work or so

  [[noreturn]] void refuse(std::size_t most, const char* what) const {
    throw LimitError(root_ + ": more than " + std::to_string(most) + what +
                     ", links to directories followed, expected fewer");
  }

  std::string root_;
  std::size_t most_;
  std::size_t directories_ = 0;  // looked into, also again by other links
  std::vector<DirectoryIdentity> ancestors_;
  std::vector<BatchMesh> meshes_;
};

// A file or directory on the command line or in a list.
void add_path(const std::string& path, FoundMeshes& found) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    const std::vector<BatchMesh> meshes = DirectorySearch(path, most_meshes()).meshes();
    found.meshes.insert(found.meshes.end(), meshes.begin(), meshes.end());
    found.directories.push_back(path);
  } else {
    found.meshes.push_back({path, own_name(path), "", stamp_of(path)});
  }
}

// What is not there is a mesh that is missing where it is named as a file. A directory that is missing would else be a
// batch of one mesh, which no one meant.
void refuse_missing_directory(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) return;
  const int error = errno;
  if (own_name(path).ends_with('/') || !fs::path(path).has_extension()) {
    throw InputError(path + ": cannot be read: " + std::generic_category().message(error) +
                     ", expected a mesh, a directory or @LIST");
  }
}

void add_operand(const std::string& operand, PathEnd path_end, FoundMeshes& found) {
  if (operand.empty() || operand == "@")
    throw UsageError("MESH|DIR|@LIST: expected a mesh, a directory or a list, not an empty name");
  if (operand.starts_with('@') || operand == "-") {
    const std::string list = operand == "-" ? operand : operand.substr(1);
    constexpr const char* kHint = "; -0 reads lists whose paths end with NUL";
    for (const std::string& path : paths_in_list(read_list(list), list, path_end, kHint)) {
      add_path(path == "-" ? "./-" : path, found);  // a file, not standard input
    }
  } else {
    refuse_missing_directory(operand);
    add_path(operand, found);
  }
}

std::string output_name(const std::string& name, const MeshSearch& search) {
  if (search.full_names) return name + '.' + search.extension;
  return fs::path(without_packing_extension(name)).replace_extension(search.extension).string();
}

std::string paths_of(const std::vector<const BatchMesh*>& meshes) {
  constexpr std::size_t kMostNamed = 3;
  std::vector<std::string> paths;
  for (const BatchMesh* const mesh : meshes) paths.push_back(mesh->path);
  return enumerated(first_words(std::move(paths), kMostNamed), " and ");
}

bool have_one_name(const std::vector<const BatchMesh*>& meshes) {
  return std::ranges::all_of(meshes, [&](const BatchMesh* mesh) { return mesh->name == meshes.front()->name; });
}

std::string collision_text(const std::vector<const BatchMesh*>& meshes) {
  const std::string all = meshes.size() == 2 ? ": would both be " : ": would all be ";
  const BatchMesh& first = *meshes.front();
  return paths_of(meshes) + all +
         (have_one_name(meshes) ? first.name + " in the results" : "written to " + first.output);
}

// Results are kept by name, outputs by theirs: both must be unique.
void refuse_collisions(const std::vector<BatchMesh>& meshes) {
  constexpr std::size_t kMostListed = 10;
  std::map<std::string, std::vector<const BatchMesh*>> by_output;
  for (const BatchMesh& mesh : meshes) by_output[mesh.output].push_back(&mesh);
  std::erase_if(by_output, [](const auto& output) { return output.second.size() == 1; });
  if (by_output.empty()) return;
  std::string text;
  bool full_names_help = false, directories_help = false;
  std::size_t listed = 0;
  for (const auto& [output, same] : by_output) {
    (have_one_name(same) ? directories_help : full_names_help) = true;
    if (listed++ < kMostListed) text += (text.empty() ? "" : "; ") + collision_text(same);
  }
  if (listed > kMostListed) text += "; and " + std::to_string(listed - kMostListed) + " more";
  if (full_names_help) text += "; --full-names keeps them apart";
  if (directories_help) text += "; names are unique within a directory that is searched: give that in place of files";
  throw UsageError(text);
}

// Of one name, in one directory: a link elsewhere to the same file may refer to other files beside it.
bool same_file(const BatchMesh& a, const BatchMesh& b) {
  std::error_code error;
  return a.name == b.name && (a.path == b.path || fs::equivalent(directory_of(a.path), directory_of(b.path), error));
}

}  // namespace

FoundMeshes find_meshes(const MeshSearch& search) {
  FoundMeshes found;
  std::vector<BatchMesh>& meshes = found.meshes;
  for (const std::string& operand : search.operands) add_operand(operand, search.path_end, found);
  std::ranges::stable_sort(meshes, {}, &BatchMesh::name);
  meshes.erase(std::unique(meshes.begin(), meshes.end(), same_file), meshes.end());
  for (BatchMesh& mesh : meshes) mesh.output = output_name(mesh.name, search);
  refuse_collisions(meshes);
  return found;
}

std::string path_from_root(const BatchMesh& mesh) {
  std::error_code error;
  const fs::path path = fs::absolute(mesh.path, error);
  return error ? mesh.path : path.string();
}

bool is_within(const std::string& path, const std::string& directory) {
  std::error_code error;
  const auto normal = [&error](const std::string& name) {
    return (fs::absolute(name, error) / "").lexically_normal().string();
  };
  return normal(path).starts_with(normal(directory)) && !error;
}

}  // namespace raycone
