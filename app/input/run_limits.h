// The limits of a run: threads, memory, time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/options/run_options.h"
#include "core/machine/threads.h"

namespace raycone {

// The limits of a run on `mesh`, in force while this lives. One at a time.
class RunLimits {
 public:
  RunLimits(const RunOptions& options, const std::string& mesh);

  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] std::uint64_t memory() const { return memory_; }  // bytes

 private:
  int threads_;
  ThreadLimit thread_limit_;
  std::uint64_t memory_;  // found once the workers' stacks are there
};

// What the machine lacks is a limit of the run: throws LimitError that names `mesh` and the limit (nullptr: unknown
// yet) where the exception being handled is of memory, threads or Embree, and that exception again where it is not.
[[noreturn]] void rethrow_as_limit(const std::string& mesh, const RunLimits* limits);

// body(limits), which are those of `options`.
template <typename Body>
auto within_limits(const RunOptions& options, const std::string& mesh, const Body& body) {
  std::optional<RunLimits> limits;
  try {
    limits.emplace(options, mesh);
    return body(*limits);
  } catch (...) {
    rethrow_as_limit(mesh, limits ? &*limits : nullptr);
  }
}

}  // namespace raycone
