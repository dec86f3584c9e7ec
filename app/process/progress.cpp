// Plain text without colours, so that NO_COLOR has nothing to switch off.
#include "app/process/progress.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "app/process/terminal.h"
#include "app/text/readable_count.h"
#include "io/files/counted.h"

namespace raycone {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kInterval{100};

std::string progress_line(std::uint64_t done, std::optional<std::uint64_t> total, double seconds) {
  const auto count = static_cast<double>(done);
  const double rate = seconds > 0.0 ? count / seconds : 0.0;
  if (!total) return counted(done, "sample") + "  " + readable_count(rate, "samples/s");
  const auto all = static_cast<double>(*total);
  std::string line = std::to_string(static_cast<int>(100.0 * count / all)) + " %  " + readable_count(rate, "samples/s");
  if (rate > 0.0) line += "  " + readable_time((all - count) / rate) + " left";
  return line;
}

}  // namespace

std::string readable_time(double seconds) {
  constexpr double kMost = 1e15;  // more than anybody waits for
  const long long whole = std::llround(std::clamp(seconds, 0.0, kMost));
  char text[48];
  if (whole < 3600) {
    std::snprintf(text, sizeof text, "%lld:%02lld", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
  }
  return text;
}

bool progress_is_shown(ProgressMode mode, const std::string& output) {
  if (mode == ProgressMode::kNever) return false;
  if (mode == ProgressMode::kAlways) return true;
  const bool results_on_terminal = output == "-" && isatty(STDOUT_FILENO);
  return isatty(STDERR_FILENO) && !results_on_terminal;
}

Progress::Progress(bool shown, std::optional<std::uint64_t> total) : total_(total) {
  if (total_ == 0U) total_.reset();
  if (!shown) return;
  try {
    thread_ = std::thread([this] { show_until_stopped(); });
  } catch (const std::system_error&) {
    return;  // where threads are short, the work goes on in silence
  }
}

Progress::~Progress() { stop(); }

void Progress::set_stage(const char* stage) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  start_ = Clock::now();
}

void Progress::interrupt(const std::function<void()>& write) {
  const std::lock_guard lock(mutex_);
  if (thread_.joinable()) erase_line();
  write();
}

void Progress::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_one();
  thread_.join();
  erase_line();
}

void Progress::show_until_stopped() {
  std::unique_lock lock(mutex_);
  do {
    const std::chrono::duration<double> elapsed = Clock::now() - start_;
    const std::string line = stage_ ? std::string(stage_) + "  " + readable_time(elapsed.count())
                                    : progress_line(done_, total_, elapsed.count());
    rewrite_line(line);
  } while (!changed_.wait_for(lock, kInterval, [this] { return stopped_; }));
}

}  // namespace raycone
