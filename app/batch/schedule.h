// Which mesh of a batch is next, and with how many threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace raycone {

// Large meshes go first, so that none of them is still running when all else is done; those of similar size in their
// given order. Threads in proportion: each mesh gets as large a part of all threads as it is of the remaining work, at
// least one, and what would otherwise lie idle. Small meshes thus run side by side, one thread each, which costs the
// least; a mesh that outweighs the others gets most threads.
class Schedule {
 public:
  // `sizes` of the meshes, bytes. Never more than `threads` in all, nor more than `jobs` meshes, at a time.
  Schedule(const std::vector<std::uint64_t>& sizes, int threads, int jobs);

  struct Start {
    std::size_t mesh = 0;  // its position in `sizes`
    int threads = 1;
  };

  // What shall start now, if anything.
  [[nodiscard]] std::optional<Start> next();
  void finished(const Start& start);
  // It could not start: it is next again, and from now on no more meshes run at a time than do now.
  void put_off(const Start& start);

  // The part of the work that has been done, 0 to 1.
  [[nodiscard]] double progress() const;

 private:
  [[nodiscard]] double weight(std::size_t mesh) const;

  std::vector<std::uint64_t> sizes_;
  std::deque<std::size_t> waiting_;
  double waiting_weight_ = 0.0;
  double done_weight_ = 0.0;
  double all_weight_ = 0.0;
  int threads_;
  int free_threads_;
  int free_jobs_;
};

}  // namespace raycone
