// What a batch tells its user at the end.
#pragma once

#include <cstddef>
#include <string>

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

// One line for standard error: counts, failures by cause, time, samples per second; what was kept, pruned and not done.
[[nodiscard]] std::string summary_line(const BatchOutcome& outcome);

}  // namespace raycone
