// Threads: the only header that evaluators and the application use for parallelism.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>

namespace raycone {

// The system starts no thread, for want of memory for its stack or by a limit on processes.
class ThreadsUnavailable : public std::runtime_error {
 public:
  ThreadsUnavailable() : std::runtime_error("cannot start threads: too little memory, or a limit on processes") {}
};

// Caps the threads of this process (ours, Embree's, OpenVDB's: all of them run on TBB) while it lives. Create exactly
// one, before the first evaluation. count >= 1.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

// Threads that parallel_for() may use, at least 1.
[[nodiscard]] int thread_count();

// Starts all of TBB's workers, in the floating-point environment of the caller. Call before Embree is first used:
// workers inherit the environment of the thread that starts them, and Embree's is flush-to-zero; and before memory is
// capped, so that none lacks a stack later. Throws ThreadsUnavailable.
void prime_threads();

// Calls body(begin, end) for disjoint ranges that cover [0, count), on the allowed threads, each with the default
// floating-point environment (MXCSR 0x1F80: round to nearest, no flush to zero). Ranges hold at least `grain` items
// where count allows. While the caller waits for other threads it takes no part in other loops: one within the body of
// another may hold a lock. A lock for which bodies of one loop wait makes them wait in vain, so that what many need is
// to be built before the loop. Exceptions of body propagate. Throws ThreadsUnavailable.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

// Calls work(), which uses threads by other means than parallel_for(), likewise: it takes no part in loops outside.
void isolated(const std::function<void()>& work);

}  // namespace raycone
