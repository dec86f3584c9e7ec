// The options that say which points are drawn, with their conversion.
#pragma once

#include <optional>

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/points_command.h"

namespace raycone {

[[nodiscard]] OptionGroup sample_group();
// Nothing without --sample. Throws UsageError.
[[nodiscard]] std::optional<SampleRequest> parse_sample(const Values& values);

}  // namespace raycone
