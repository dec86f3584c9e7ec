// core/machine/threads.h on standard threads, in place of core/machine/threads.cpp in builds for ThreadSanitizer:
// Debian's TBB is not built for it, so that every hand-over between TBB's threads looks like a race and the real ones
// drown.
#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

#include "core/machine/floating_point.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

std::atomic<int> allowed_threads{4};  // more than the machine may have: races want company

}  // namespace

struct ThreadLimit::Control {
  int before;
};

ThreadLimit::ThreadLimit(int count) : control_(new Control{allowed_threads.exchange(count)}) {}
ThreadLimit::~ThreadLimit() { allowed_threads = control_->before; }

int thread_count() { return allowed_threads; }

void prime_threads() {}

// Thread t of T takes ranges t, t + T, ... without synchronisation: all work however short the loop is, and nothing but
// the end of the loop orders what they do.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t step = std::max<std::size_t>(grain, 1);
  const auto thread_count = static_cast<std::size_t>(allowed_threads);
  std::vector<std::exception_ptr> failures(thread_count);
  const auto work = [&](std::size_t thread) {
    const DefaultFloatingPoint guard;
    try {
      for (std::size_t begin = thread * step; begin < count; begin += thread_count * step) {
        body(begin, std::min(begin + step, count));
      }
    } catch (...) {
      failures[thread] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  bool available = true;
  try {
    for (std::size_t i = 0; i < thread_count; ++i) threads.emplace_back(work, i);
  } catch (const std::system_error&) {
    available = false;
  }
  for (std::thread& thread : threads) thread.join();
  if (!available) throw ThreadsUnavailable();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

// Who waits for these threads does nothing else.
void isolated(const std::function<void()>& work) { work(); }

}  // namespace raycone
