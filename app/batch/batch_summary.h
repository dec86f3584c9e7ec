// What a batch tells its user while it runs and at the end.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/batch/batch_record.h"

namespace raycone {

// The progress line of a batch on standard error: done of all, rate, time left, failures.
class BatchProgress {
 public:
  BatchProgress(bool shown, std::size_t meshes) : shown_(shown), meshes_(meshes) {}
  ~BatchProgress() { erase(); }
  BatchProgress(const BatchProgress&) = delete;
  BatchProgress& operator=(const BatchProgress&) = delete;

  // `part` of the work is done, 0 to 1.
  void add(bool failed, double part);
  void show();
  // To be called before anything else is printed.
  void erase();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  bool drawn_ = false;  // there is something to erase
  std::size_t meshes_;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  double part_ = 0.0;
  Clock::time_point start_ = Clock::now();
};

// What came of the meshes of a batch.
struct BatchOutcome {
  BatchRecords evaluated;  // now
  BatchRecords kept;       // of earlier runs, still valid
  std::size_t not_done = 0;
  double seconds = 0.0;  // wall clock

  [[nodiscard]] bool any_failed() const;
};

// Lines for standard error: counts, failures by cause, samples per second, the ten slowest meshes.
[[nodiscard]] std::vector<std::string> summary_lines(const BatchOutcome& outcome);

}  // namespace raycone
