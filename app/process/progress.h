// The progress line on standard error: percentage, rate, time left.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace raycone {

enum class ProgressMode { kAuto, kAlways, kNever };

// Whether to show progress: on a terminal that is not already busy with the results, unless told otherwise. `output`:
// where these go, "-" for standard output.
[[nodiscard]] bool progress_is_shown(ProgressMode mode, const std::string& output);

// "1:05", "2:00:00"
[[nodiscard]] std::string readable_time(double seconds);

// Rewrites one line about `done` from a thread of its own, at most ten times a second, until stop().
class Progress {
 public:
  // `total` samples, where known. Without a thread for it, nothing is shown.
  Progress(bool shown, std::optional<std::uint64_t> total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // The count of finished samples, to be increased by the work.
  [[nodiscard]] std::atomic<std::uint64_t>* done() { return &done_; }
  // What the work is at instead of samples; until nullptr, which it is at first. Stays valid.
  void set_stage(const char* stage);
  // Calls write(), which may write lines to standard error. Ours is out of the way meanwhile.
  void interrupt(const std::function<void()>& write);
  // Erases the line; nothing is written afterwards.
  void stop();

 private:
  void show_until_stopped();

  std::optional<std::uint64_t> total_;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;  // this and what follows is guarded by mutex_
  const char* stage_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();  // of the stage
  std::thread thread_;                                                              // runs only where progress is shown
};

}  // namespace raycone
