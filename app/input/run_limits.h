// The limits of a run: threads, memory, time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/options/run_options.h"
#include "core/machine/threads.h"

namespace raycone {

// The limits of a run on `mesh`, in force while this lives. Only one may live at a time.
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

// Call it in a catch block. Where the exception being handled is about memory, threads or Embree, throws a LimitError
// that names `mesh` and the limit; else throws the exception again. `limits`: nullptr where they are not known yet.
[[noreturn]] void rethrow_as_limit(const std::string& mesh, const RunLimits* limits);

// Returns body(limits) under the limits of `options`. Throws as rethrow_as_limit().
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
