// Threads. All parallelism goes through this header.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>

namespace raycone {

// The system cannot start a thread: there is no memory for its stack, or a limit on processes.
class ThreadsUnavailable : public std::runtime_error {
 public:
  ThreadsUnavailable() : std::runtime_error("cannot start threads: too little memory, or a limit on processes") {}
};

// Caps the number of threads of this process while it lives: ours, Embree's and OpenVDB's, which all run on TBB. Create
// exactly one, before the first evaluation. Precondition: count >= 1.
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

// Starts all of TBB's workers, in the floating-point environment of the caller. Call it before Embree is first used:
// workers inherit the environment of the thread that starts them, and Embree flushes to zero. Call it before memory is
// capped, too, so that no worker lacks a stack later. Where they do not come within a second it goes on without. Throws
// ThreadsUnavailable.
void prime_threads();

// Calls body(begin, end) for disjoint ranges that cover [0, count), on the allowed threads. Each call has the default
// floating-point environment (MXCSR 0x1F80: round to nearest, no flush to zero). Loops of up to `grain` items are
// not divided; of longer ones no range has less than half as many. Exceptions of body propagate. Throws
// ThreadsUnavailable.
//
// A caller that waits for other threads takes no part in other loops. A loop within the body of another may therefore
// hold a lock. Bodies of one loop must not wait for a lock that one of them holds while it runs a loop: build what many
// need before the loop.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

// Calls body(n) for each n below `count`, as parallel_for() does for ranges of them.
template <class Body>
void parallel_for_each(std::size_t count, std::size_t grain, const Body& body) {
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) body(n);
  });
}

// Of grain 1: for bodies that take some microseconds.
template <class Body>
void parallel_for_each(std::size_t count, const Body& body) {
  parallel_for_each(count, 1, body);
}

// Calls work(), which may use threads by other means than parallel_for(). It takes no part in loops outside either.
void isolated(const std::function<void()>& work);

}  // namespace raycone
