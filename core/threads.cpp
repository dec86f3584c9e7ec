#include "core/threads.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "core/floating_point.h"

namespace raycone {

struct ThreadLimit::Control {
  tbb::global_control parallelism;
};

ThreadLimit::ThreadLimit(int count)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)}}) {}
ThreadLimit::~ThreadLimit() = default;

int thread_count() {
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(static_cast<int>(allowed), tbb::this_task_arena::max_concurrency());
}

void prime_threads() {
  parallel_for(1, 1, [](std::size_t, std::size_t) {});
}

static void run_loop(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  const tbb::blocked_range<std::size_t> all(0, count, std::max<std::size_t>(grain, 1));
  try {
    tbb::parallel_for(all, [&body](const tbb::blocked_range<std::size_t>& range) {
      const DefaultFloatingPoint guard;
      body(range.begin(), range.end());
    });
  } catch (const std::runtime_error& error) {
    // All that tells TBB's exception from others.
    if (std::string_view(error.what()).starts_with("pthread_create")) throw ThreadsUnavailable();
    throw;
  }
}

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  isolated([&] { run_loop(count, grain, body); });
}

void isolated(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

}  // namespace raycone
