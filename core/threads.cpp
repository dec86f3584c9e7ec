#include "core/threads.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string_view>

#include "core/floating_point.h"

namespace raycone {

namespace {

// What a loop's body threw. Its own text, which may start with any file's name, must not be taken for TBB's.
struct BodyException {
  std::exception_ptr cause;
};

}  // namespace

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

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  const tbb::blocked_range<std::size_t> all(0, count, std::max<std::size_t>(grain, 1));
  try {
    tbb::parallel_for(all, [&body](const tbb::blocked_range<std::size_t>& range) {
      const DefaultFloatingPoint guard;
      try {
        body(range.begin(), range.end());
      } catch (...) {
        throw BodyException{std::current_exception()};
      }
    });
  } catch (const BodyException& exception) {
    std::rethrow_exception(exception.cause);
  } catch (const std::runtime_error& error) {
    // All that tells this exception of TBB's from its others.
    if (std::string_view(error.what()).starts_with("pthread_create")) throw ThreadsUnavailable();
    throw;
  }
}

}  // namespace raycone
