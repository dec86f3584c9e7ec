#pragma once

#include <string>
#include <vector>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/options.h"

namespace raycone {

[[nodiscard]] CommandSpec batch_spec();
[[nodiscard]] Command parse_batch(const Values& values);

// What a batch does to one mesh, whose files and limits are yet to be filled in: a lattice, or with --sample among the
// options the points that are drawn. `format` and `options`: as in BatchCommand. Throws UsageError.
[[nodiscard]] MeshCommand mesh_command_of(const std::string& format, const std::vector<std::string>& options);

}  // namespace raycone
