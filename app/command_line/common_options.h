// The options that commands share, with their conversion. Values that an option does not take: UsageError.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/mesh_options.h"
#include "app/options/output_options.h"
#include "app/options/run_options.h"

namespace raycone {

[[nodiscard]] OperandSpec mesh_operand();
[[nodiscard]] OperandSpec meshes_operand();  // of commands that label parts
[[nodiscard]] OptionGroup mesh_group();
[[nodiscard]] MeshOptions parse_mesh(const Values& values);

// `formats` stands for the value of --format in the help.
[[nodiscard]] OptionGroup output_group(const std::string& formats);

// --no-clobber
[[nodiscard]] Existing parse_existing(const Values& values);
[[nodiscard]] OutputFiles parse_output_files(const Values& values);

// The formats that a command writes.
struct OutputFormats {
  std::vector<FieldFormat> written;      // in the order in which messages list them
  std::optional<FieldFormat> only = {};  // of --raw; the output's name may not promise another one
  std::string contents = "lattices";     // what other formats do not hold
};
// Of values that go to `output`: --format, --dtype and --pack-bits.
[[nodiscard]] FieldEncoding parse_encoding(const Values& values, const OutputFiles& output,
                                           const OutputFormats& formats);

// --pack-bits, of commands that write NPZ.
[[nodiscard]] OptionSpec pack_bits_option();

// Whether `path` ends with a dot and `extension`, which is in lower case, in any case.
[[nodiscard]] bool has_extension(const std::string& path, const std::string& extension);

[[nodiscard]] OptionGroup run_group();
[[nodiscard]] RunOptions parse_run(const Values& values);

}  // namespace raycone
