// `raycone info`: what a mesh is, and what evaluation will cost.
#pragma once

#include <string>

#include "app/options/command.h"
#include "app/run/run_limits.h"

namespace raycone {

// What is to be printed. Warnings about the mesh are printed here. Throws UsageError, InputError, LimitError.
[[nodiscard]] std::string run_info(const InfoCommand& command, const RunLimits& limits);

}  // namespace raycone
