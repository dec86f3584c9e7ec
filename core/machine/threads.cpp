#include "core/machine/threads.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "core/machine/floating_point.h"

namespace raycone {
namespace {

// What a loop's body threw. Its own text, which may start with any file's name, must not be taken for TBB's.
struct BodyException {
  std::exception_ptr cause;
};

// Workers that have run a loop's body.
std::atomic<std::size_t> workers{0};

// Counts the calling thread where it is a worker and was not counted yet.
void count_worker() {
  thread_local bool counted = false;
  if (counted || tbb::this_task_arena::current_thread_index() == 0) return;
  counted = true;
  ++workers;
}

void run_loop(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  const tbb::blocked_range<std::size_t> all(0, count, std::max<std::size_t>(grain, 1));
  try {
    tbb::parallel_for(all, [&body](const tbb::blocked_range<std::size_t>& range) {
      const DefaultFloatingPoint guard;
      count_worker();
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

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  isolated([&] { run_loop(count, grain, body); });
}

void isolated(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

namespace {

using Clock = std::chrono::steady_clock;

// Lets others run until `done()`, but not beyond `end`. Time is what counts, as each look may last as long as all
// others want the CPU.
template <class Done>
void wait_until(const Done& done, Clock::time_point end) {
  while (!done() && Clock::now() < end) std::this_thread::yield();
}

// TBB starts a worker for what is enqueued even on a single CPU, and OpenVDB enqueues: where it could not be started
// then, the process would be terminated. Where there are other workers they do: one that was called for what is
// enqueued goes on looking for work, beyond the number of threads that is allowed.
void start_worker_for_enqueued(Clock::time_point end) {
  const auto done = std::make_shared<std::atomic<bool>>(false);
  tbb::task_arena().enqueue([done] { *done = true; });
  wait_until([&] { return done->load(); }, end);
}

}  // namespace

// Within a loop all workers may be in bodies that wait for this one: they are there already then. A system that starts
// no more threads goes on with fewer, after a second: of all bodies together, which a thread that is alone does in
// turn.
void prime_threads() {
  constexpr std::chrono::seconds kPatience{1};
  const Clock::time_point end = Clock::now() + kPatience;
  const auto count = static_cast<std::size_t>(thread_count());
  const auto all_started = [&] { return workers + 1 >= count; };
  if (!all_started()) parallel_for(count, 1, [&](std::size_t, std::size_t) { wait_until(all_started, end); });
  try {
    if (tbb::this_task_arena::max_concurrency() == 1) start_worker_for_enqueued(end);
  } catch (const std::runtime_error&) {
    throw ThreadsUnavailable();
  }
}

}  // namespace raycone
