// raycone lattice: its options, and those of its box, which others share.
#pragma once

#include <string>
#include <variant>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"
#include "app/options/lattice_request.h"

namespace raycone {

[[nodiscard]] CommandSpec lattice_spec();
[[nodiscard]] Command parse_lattice(const Values& values);  // throws UsageError

[[nodiscard]] OptionGroup lattice_group();
// The parts of it; all throw UsageError.
[[nodiscard]] std::variant<LatticeRequest, GridReference> parse_lattice_request(const Values& values);
[[nodiscard]] Box parse_bounds(const std::string& text);
[[nodiscard]] std::variant<WorldPadding, VoxelPadding> parse_padding(const std::string& text);

}  // namespace raycone
