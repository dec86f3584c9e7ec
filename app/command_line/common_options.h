// The options that commands share, with their conversion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/options.h"

namespace raycone {

[[nodiscard]] OperandSpec mesh_operand();
[[nodiscard]] OptionGroup mesh_group();
[[nodiscard]] MeshOptions parse_mesh(const Values& values);

// `formats` stands for the value of --format in the help.
[[nodiscard]] OptionGroup output_group(const std::string& formats);

[[nodiscard]] OutputFiles parse_output_files(const Values& values);

// The formats that a command writes.
struct OutputFormats {
  std::vector<FieldFormat> written;
  std::string listed;                    // for messages
  std::optional<FieldFormat> only = {};  // whatever the output is called
};
[[nodiscard]] OutputOptions parse_output(const Values& values, const OutputFormats& formats);

[[nodiscard]] OptionGroup run_group();
[[nodiscard]] RunOptions parse_run(const Values& values);

}  // namespace raycone
