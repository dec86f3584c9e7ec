// The meshes of a batch: from operands to files, and the outputs they are to have.
#pragma once

#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/options/batch_command.h"

namespace raycone {

struct BatchMesh {
  std::string path;    // to open, and for messages
  std::string name;    // relative to the directory given, or the file's own name: its identity in the results
  std::string output;  // relative to the directory of outputs
  FileStamp stamp;
};

struct FoundMeshes {
  std::vector<BatchMesh> meshes;
  std::vector<std::string> directories;  // that were searched
};

// In byte order of their names, none of which is empty; a file given twice is there once. Directories are searched
// recursively for the extensions of meshes, in any case, symbolic links followed but never in circles. A directory that
// cannot be read is there itself, its name ending with a slash: as a mesh it will fail with the reason. So will a mesh
// that is missing. Throws InputError for a list that cannot be read, or a directory that is missing on the command
// line; UsageError for meshes with one output.
[[nodiscard]] FoundMeshes find_meshes(const MeshSearch& search);

// Where it is, whatever the working directory.
[[nodiscard]] std::string path_from_root(const BatchMesh& mesh);

// Whether `path` is `directory` or within it, going by their names; both may be relative to the working directory.
[[nodiscard]] bool is_within(const std::string& path, const std::string& directory);

}  // namespace raycone
