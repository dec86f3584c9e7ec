// raycone batch: its options.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

[[nodiscard]] CommandSpec batch_spec();
[[nodiscard]] Command parse_batch(const Values& values);  // throws UsageError

}  // namespace raycone
