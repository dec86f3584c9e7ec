// What a run may use, and what it tells its user.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/process/progress.h"

namespace raycone {

struct RunOptions {
  std::optional<int> threads;                 // else default_threads()
  std::optional<std::uint64_t> memory_limit;  // bytes; else available_memory()
  std::optional<double> timeout;              // seconds
  ProgressMode progress = ProgressMode::kAuto;
  bool quiet = false;
  bool strict = false;
  std::vector<std::string> options;  // given ones that results depend on, for files to keep
  std::vector<std::string> words;    // the command line

  // Those who want quiet want none.
  [[nodiscard]] ProgressMode progress_mode() const { return quiet ? ProgressMode::kNever : progress; }
};

}  // namespace raycone
