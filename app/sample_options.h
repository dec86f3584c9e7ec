// The options that say which points are drawn, with their conversion.
#pragma once

#include <optional>

#include "app/command_spec.h"
#include "app/sampled_points.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] OptionGroup sample_group();
// Nothing without --sample. Throws UsageError.
[[nodiscard]] std::optional<SampleRequest> parse_sample(const Values& values);

}  // namespace raycone
