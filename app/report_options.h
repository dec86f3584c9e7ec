#pragma once

#include "app/command_spec.h"
#include "app/options.h"
#include "app/values.h"

namespace raycone {

[[nodiscard]] CommandSpec report_spec();
[[nodiscard]] Command parse_report(const Values& values);

}  // namespace raycone
