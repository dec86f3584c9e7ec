// Wall-clock times of the parts of a run.
#pragma once

#include <chrono>
#include <utility>

namespace raycone {

// Adds the time until its end to `seconds`.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

// What `work` returns; the time it takes is added to `seconds`.
template <typename Work>
auto timed(double& seconds, Work&& work) {
  const Stopwatch stopwatch(seconds);
  return std::forward<Work>(work)();
}

}  // namespace raycone
