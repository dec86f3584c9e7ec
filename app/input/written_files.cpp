#include "app/input/written_files.h"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <system_error>
#include <variant>

#include "app/process/usage_error.h"
#include "io/files/ascii.h"
#include "io/files/file_identity.h"

namespace raycone {
namespace {

std::string name_of_output(const std::string& path) { return path == "-" ? "standard output" : path; }

template <class Format>
FileContent content_of(Format format) {
  return is_text(format) ? FileContent::kText : FileContent::kBytes;
}

std::vector<WrittenFile> files_written(const OutputFiles& output, FileContent content) {
  std::vector<WrittenFile> written{{output.path, "output", content}};
  if (output.report) written.push_back({*output.report, "report"});
  if (output.depfile) written.push_back({*output.depfile, "depfile"});
  return written;
}

std::vector<std::string> paths_of(const MeshOptions& mesh) {
  std::vector<std::string> paths{mesh.path};
  paths.insert(paths.end(), mesh.further.begin(), mesh.further.end());
  paths.insert(paths.end(), mesh.lists.begin(), mesh.lists.end());
  return paths;
}

std::vector<std::string> inputs_of(const MeshOptions& mesh,
                                   const std::variant<LatticeRequest, GridReference>& lattice) {
  std::vector<std::string> inputs = paths_of(mesh);
  if (const auto* const grid = std::get_if<GridReference>(&lattice)) inputs.push_back(grid->path);
  return inputs;
}

}  // namespace

std::vector<WrittenFile> files_written(const LatticeCommand& command) {
  std::vector<WrittenFile> written = files_written(command.output, content_of(command.encoding.format));
  if (const std::optional<std::string> names = label_names_path(command)) written.push_back({*names, "label names"});
  return written;
}

std::vector<WrittenFile> files_written(const PointsCommand& command) {
  return files_written(command.output, content_of(command.encoding.format));
}

std::vector<WrittenFile> files_written(const SliceCommand& command) {
  std::vector<WrittenFile> written = files_written(command.output, FileContent::kBytes);
  if (command.values) written.push_back({*command.values, "values", FileContent::kBytes});
  return written;
}

std::vector<WrittenFile> files_written(const SurfaceCommand& command) {
  return files_written(command.output, content_of(command.format));
}

std::vector<WrittenFile> files_written(const InfoCommand& command) {
  std::vector<WrittenFile> written{{"-", "output"}};
  if (command.mark) written.push_back({*command.mark, "marked mesh"});
  return written;
}

std::vector<std::string> inputs_of(const LatticeCommand& command) { return inputs_of(command.mesh, command.lattice); }

std::vector<std::string> inputs_of(const PointsCommand& command) {
  std::vector<std::string> inputs = paths_of(command.mesh);
  if (!command.sample) inputs.push_back(command.points);
  return inputs;
}

std::vector<std::string> inputs_of(const SliceCommand& command) { return paths_of(command.mesh); }

std::vector<std::string> inputs_of(const SurfaceCommand& command) { return inputs_of(command.mesh, command.lattice); }

// What is no regular file has no neighbours.
std::optional<std::string> label_names_path(const LatticeCommand& command) {
  const FieldFormat format = command.encoding.format;
  const bool nifti = format == FieldFormat::kNifti || format == FieldFormat::kNiftiGz;
  std::string path = command.output.path;
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  const bool regular = type == std::filesystem::file_type::regular || type == std::filesystem::file_type::not_found;
  if (!nifti || !command.field.has(Field::kLabel) || path == "-" || !regular) return std::nullopt;
  for (const std::string end : {".nii", ".nii.gz"}) {
    if (!ends_with_word(path, end)) continue;
    path.resize(path.size() - end.size());
    break;
  }
  path += ".json";
  const auto canonical = [&](const std::string& name) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(name, error), error);
  };
  const std::optional<std::string>& report = command.output.report;
  const bool is_report = report && (*report == path || canonical(*report) == canonical(path));
  return is_report ? std::nullopt : std::optional(path);
}

std::unique_ptr<OutputFile> open_label_names(const LatticeCommand& command, OutputGroup& group) {
  const std::optional<std::string> path = label_names_path(command);
  return path ? std::make_unique<OutputFile>(*path, command.output.existing, &group) : nullptr;
}

void refuse_to_replace_input(const std::vector<WrittenFile>& written, const std::vector<std::string>& inputs) {
  std::vector<std::optional<FileIdentity>> read;
  for (const std::string& input : inputs) read.push_back(identity_of_input(input));
  for (std::size_t n = 0; n < written.size(); ++n) {
    const std::string& path = written[n].path;
    const std::string& role = written[n].role;
    const std::optional<FileIdentity> identity = identity_of_output(path);
    if (identity && std::ranges::count(read, identity) > 0) {
      throw ReplacesFileError(name_of_output(path) + ": is input and " + role);
    }
    for (std::size_t before = 0; before < n; ++before) {
      const std::string& other = written[before].path;
      if (path == other || (identity && identity == identity_of_output(other)) || are_one_pipe(path, other)) {
        throw ReplacesFileError(name_of_output(path) + ": is " + written[before].role + " and " + role);
      }
    }
  }
}

void refuse_terminal(const std::vector<WrittenFile>& written) {
  const bool bytes = std::ranges::any_of(
      written, [](const WrittenFile& file) { return file.path == "-" && file.content == FileContent::kBytes; });
  if (!bytes || !isatty(STDOUT_FILENO)) return;
  throw UsageError("standard output: is a terminal, which cannot show this format; expected -o FILE, or a pipe behind");
}

}  // namespace raycone
