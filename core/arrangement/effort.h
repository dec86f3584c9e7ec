// How long a computation may go on.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/machine/threads.h"

namespace raycone {

// A budget of steps. A step takes from a fraction of a microsecond to a few microseconds.
class Effort {
 public:
  explicit Effort(std::uint64_t steps) : left_(steps) {}

  // Takes `steps`. False where fewer are left: then all are used up.
  [[nodiscard]] bool take(std::uint64_t steps = 1) {
    const bool are_left = steps <= left_;
    left_ -= are_left ? steps : left_;
    return are_left;
  }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  std::uint64_t left_;
};

// Calls work(n, effort) for each n below `count`, on the threads that ThreadLimit allows. False if one of the calls
// returns false, or if together they take all steps that there are: the same for any number of threads, as work that
// lacks steps takes more than are left, whichever work comes first.
template <class Work>
[[nodiscard]] bool parallel_for_each(std::size_t count, Effort& effort, const Work& work) {
  const std::uint64_t most = effort.left();
  std::atomic<std::uint64_t> taken = 0;
  parallel_for_each(count, [&](std::size_t n) {
    const std::uint64_t before = taken;
    if (before >= most) return;  // the others are in vain
    Effort own(most - before);
    const bool is_done = work(n, own) && own.left() > 0;
    taken += is_done ? most - before - own.left() : most;
  });
  return taken < most && effort.take(taken);
}

}  // namespace raycone
