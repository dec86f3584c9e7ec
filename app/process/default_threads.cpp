// Source: sched_getaffinity(2).
#include "app/process/default_threads.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "app/process/cgroups.h"
#include "app/process/usage_error.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

int affinity_cpus() {
  // The kernel refuses masks shorter than its own.
  for (std::size_t cpus = 1024; cpus <= 1U << 20; cpus *= 2) {
    cpu_set_t* const set = CPU_ALLOC(cpus);
    if (!set) return 1;
    const std::size_t size = CPU_ALLOC_SIZE(cpus);
    const int count = sched_getaffinity(0, size, set) == 0 ? CPU_COUNT_S(size, set) : 0;
    CPU_FREE(set);
    if (count > 0) return count;
  }
  return 1;
}

}  // namespace

int default_threads() {
  if (const char* const text = std::getenv("RAYCONE_THREADS"); text && *text) {
    const std::optional<std::int64_t> count = integer_from(text);
    if (count && *count >= 1 && *count <= kMaxThreads) return static_cast<int>(*count);
    throw UsageError(std::string("RAYCONE_THREADS=") + text + ": expected 1 to " + std::to_string(kMaxThreads));
  }
  const double quota = std::ceil(cgroup_cpus().value_or(kMaxThreads));
  return static_cast<int>(std::clamp<double>(quota, 1.0, std::min(affinity_cpus(), kMaxThreads)));
}

}  // namespace raycone
