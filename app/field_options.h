// The options that say what is evaluated, with their conversion.
#pragma once

#include "app/command_spec.h"
#include "app/options.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] OptionGroup field_group();
[[nodiscard]] OptionGroup unlisted_field_group();
[[nodiscard]] FieldOptions parse_field(const Values& values);

}  // namespace raycone
