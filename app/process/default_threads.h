// How many threads a run has where nobody says.
#pragma once

namespace raycone {

// Largest number of threads that may be asked for.
inline constexpr int kMaxThreads = 4096;

// RAYCONE_THREADS where set (UsageError where it is no number of threads), else the CPUs that this process may use:
// its affinity mask, capped by its cgroup's quota. At least 1.
[[nodiscard]] int default_threads();

}  // namespace raycone
