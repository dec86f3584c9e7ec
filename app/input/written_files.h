// The files that a command writes: kept apart from what it reads, and those beside its results.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/options/info_command.h"
#include "app/options/lattice_command.h"
#include "app/options/points_command.h"
#include "app/options/slice_command.h"
#include "app/options/surface_command.h"
#include "io/files/output_file.h"

namespace raycone {

enum class FileContent {
  kText,  // which a terminal can show
  kBytes,
};

// What a command writes, and as what: "output", "report", ...
struct WrittenFile {
  std::string path;  // "-": standard output
  std::string role;
  FileContent content = FileContent::kText;
};
[[nodiscard]] std::vector<WrittenFile> files_written(const LatticeCommand& command);
[[nodiscard]] std::vector<WrittenFile> files_written(const PointsCommand& command);
[[nodiscard]] std::vector<WrittenFile> files_written(const SliceCommand& command);
[[nodiscard]] std::vector<WrittenFile> files_written(const SurfaceCommand& command);
[[nodiscard]] std::vector<WrittenFile> files_written(const InfoCommand& command);

// The files that a command names to be read, the mesh first.
[[nodiscard]] std::vector<std::string> inputs_of(const LatticeCommand& command);
[[nodiscard]] std::vector<std::string> inputs_of(const PointsCommand& command);
[[nodiscard]] std::vector<std::string> inputs_of(const SliceCommand& command);
[[nodiscard]] std::vector<std::string> inputs_of(const SurfaceCommand& command);

// Where the names of labels go, beside a NIfTI image of them: the image's name with .json in place of .nii or .nii.gz.
// Nothing where no such file is written, or where the report has that name, as it has the labels' names, too.
[[nodiscard]] std::optional<std::string> label_names_path(const LatticeCommand& command);
// Opens that file; null where there is none. Throws OutputError.
[[nodiscard]] std::unique_ptr<OutputFile> open_label_names(const LatticeCommand& command, OutputGroup& group);

// Throws ReplacesFileError where one of `written` would replace or grow one of `inputs` ("-": standard input) or
// another of `written`, by whatever names: a slip of the keyboard must not cost the user an input. To be called before
// the work, and once more when it is known which files a mesh refers to.
void refuse_to_replace_input(const std::vector<WrittenFile>& written, const std::vector<std::string>& inputs);

// Throws UsageError where output that is no text would go to standard output, and that is a terminal.
void refuse_terminal(const std::vector<WrittenFile>& written);

}  // namespace raycone
