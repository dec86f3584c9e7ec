// What a run may use, and what it tells its user.
#pragma once

#include <cstdint>
#include <optional>

#include "app/process/progress.h"

namespace raycone {

struct RunOptions {
  std::optional<int> threads;                 // else default_threads()
  std::optional<std::uint64_t> memory_limit;  // bytes; else available_memory()
  std::optional<double> timeout;              // seconds
  ProgressMode progress = ProgressMode::kAuto;
  bool quiet = false;
  bool strict = false;
};

}  // namespace raycone
