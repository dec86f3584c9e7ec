// What a batch tells its user at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/batch/batch_record.h"

namespace raycone {

// What came of the meshes of a batch.
struct BatchOutcome {
  BatchRecords evaluated;  // now
  BatchRecords kept;       // of earlier runs, still valid
  std::size_t not_done = 0;
  std::size_t pruned = 0;  // rows of meshes that are gone
  double seconds = 0.0;    // wall clock

  [[nodiscard]] bool any_failed() const;
};

// Lines for standard error: counts, failures by cause, samples per second, the ten slowest meshes.
[[nodiscard]] std::vector<std::string> summary_lines(const BatchOutcome& outcome);

}  // namespace raycone
