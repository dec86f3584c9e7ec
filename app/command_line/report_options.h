// raycone report: its options.
#pragma once

#include "app/command_line/command_spec.h"
#include "app/command_line/values.h"
#include "app/options/command.h"

namespace raycone {

[[nodiscard]] CommandSpec report_spec();
[[nodiscard]] Command parse_report(const Values& values);  // throws UsageError

}  // namespace raycone
