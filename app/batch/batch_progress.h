// How far a batch is, for who waits for it.
#pragma once

#include <chrono>
#include <cstddef>

#include "app/batch/result_row.h"
#include "app/process/progress.h"

namespace raycone {

// Tells on standard error what is done of all, failures, rate and time left: on a terminal in one line that is
// rewritten; else, where progress is asked for, in a line of its own from time to time and at the end.
class BatchProgress {
 public:
  enum class Style { kNone, kRewritten, kLines };

  BatchProgress(Style style, std::size_t meshes, std::chrono::duration<double> between_lines = std::chrono::seconds(30))
      : style_(style), meshes_(meshes), between_lines_(between_lines) {}
  ~BatchProgress() { erase(); }
  BatchProgress(const BatchProgress&) = delete;
  BatchProgress& operator=(const BatchProgress&) = delete;

  // A mesh is done, and so is `part` of the work, 0 to 1.
  void add(MeshStatus status, double part);
  // To be called again and again.
  void show();
  // To be called before anything else is printed.
  void erase();

 private:
  using Clock = std::chrono::steady_clock;

  void rewrite();
  void write_line();

  Style style_;
  bool drawn_ = false;  // there is something to erase
  std::size_t meshes_;
  std::size_t done_ = 0;
  std::size_t failed_ = 0;
  double part_ = 0.0;
  std::chrono::duration<double> between_lines_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_line_ = start_;
};

// As standard error is a terminal or not.
[[nodiscard]] BatchProgress::Style progress_style(ProgressMode mode);

}  // namespace raycone
