// The options that say what is evaluated, with their conversion. Values that an option does not take: UsageError.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/field_options.h"
#include "app/options/mesh_options.h"

namespace raycone {

[[nodiscard]] OptionGroup field_group();
// The same for points, without what only lattices have.
[[nodiscard]] OptionGroup points_field_group();

// --field solid, where there is no lattice.
[[noreturn]] void refuse_solid();

[[nodiscard]] OptionSpec rule_option();
[[nodiscard]] OptionSpec parts_option();
[[nodiscard]] OptionSpec priority_option();
[[nodiscard]] OptionSpec tolerance_option();
// What --tolerance says. Precondition: it is given.
[[nodiscard]] double parse_tolerance(const Values& values);
// What --rule says. Precondition: it is given.
[[nodiscard]] Rule parse_rule(const Values& values);
// One mesh, or for labels several and their parts.
[[nodiscard]] MeshOptions parse_meshes(const Values& values, const FieldOptions& field);
[[nodiscard]] FieldOptions parse_field(const Values& values);

}  // namespace raycone
