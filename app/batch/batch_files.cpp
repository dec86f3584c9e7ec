#include "app/batch/batch_files.h"

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "app/input/written_files.h"
#include "app/process/usage_error.h"
#include "io/files/file_identity.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Names of files by their device and inode.
using FileNames = std::map<std::pair<dev_t, ino_t>, std::string>;

// Files that the batch reads beside the meshes: lists, the grid of --like.
std::vector<std::string> other_inputs(const BatchCommand& command) {
  std::vector<std::string> inputs;
  for (const std::string& operand : command.search.operands) {
    if (operand == "-") inputs.push_back(operand);
    if (operand.starts_with('@')) inputs.push_back(operand.substr(1));
  }
  if (const GridReference* const grid = grid_of(command.for_each)) inputs.push_back(grid->path);
  return inputs;
}

FileNames names_of_inputs(const BatchCommand& command, const std::vector<BatchMesh>& meshes) {
  FileNames inputs;
  const auto add = [&inputs](const std::string& path) {
    if (const auto file = identity_of_input(path)) inputs.emplace(std::pair(file->device, file->inode), path);
  };
  for (const BatchMesh& mesh : meshes) add(mesh.path);
  for (const std::string& path : other_inputs(command)) add(path);
  return inputs;
}

// Where links lead.
std::string target_of(const std::string& path) {
  const fs::path target = follow_links(path);
  std::error_code error;  // a directory that went away meanwhile is told of when it is written to
  return (fs::canonical(directory_of(target.string()), error) / target.filename()).string();
}

}  // namespace

std::vector<std::string> paths_written(const BatchCommand& command, const BatchMesh& mesh) {
  if (!command.writes) return {};
  std::vector<std::string> paths{command.directory + '/' + mesh.output};
  const auto* const for_each = std::get_if<LatticeCommand>(&command.for_each);
  if (!for_each || !for_each->field.has(Field::kLabel)) return paths;
  LatticeCommand one = *for_each;
  one.output.path = paths.front();
  if (const std::optional<std::string> names = label_names_path(one)) paths.push_back(*names);
  return paths;
}

void refuse_to_replace(const BatchCommand& command, const std::vector<BatchMesh>& meshes) {
  const FileNames inputs = names_of_inputs(command, meshes);
  std::map<std::string, std::string> meshes_by_target;
  for (const BatchMesh& mesh : meshes) {
    for (const std::string& path : paths_written(command, mesh)) {
      const std::optional<FileIdentity> file = identity_of_output(path);
      if (!file) continue;
      const auto input = inputs.find({file->device, file->inode});
      if (file->new_name.empty() && input != inputs.end()) {
        throw UsageError(mesh.path + ": its output " + path + " would replace the input " + input->second);
      }
      const auto [other, is_free] = meshes_by_target.emplace(target_of(path), mesh.path);
      if (!is_free) throw UsageError(mesh.path + ": its output " + path + " would replace that of " + other->second);
    }
  }
}

}  // namespace raycone
