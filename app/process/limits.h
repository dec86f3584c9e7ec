// What a run may use: threads, memory, time; and what it did use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace raycone {

// RAYCONE_THREADS where set (UsageError where it is no number of threads), else the CPUs that this process may use:
// its affinity mask, capped by its cgroup's quota. At least 1.
[[nodiscard]] int default_threads();

// Largest number of threads that may be asked for.
inline constexpr int kMaxThreads = 4096;

// Bytes that `ulimit -v` and `ulimit -d` leave to this process, or seven eighths of those that the machine and the
// cgroup do.
[[nodiscard]] std::uint64_t available_memory();

// Makes allocations fail with std::bad_alloc before more than `bytes` are resident in this process, code and libraries
// included. What is mapped at the time of the call and was never touched, such as stacks of threads that run, is taken
// to stay so; so are `untouched` bytes that are yet to be mapped. Never more than `ulimit -d` allowed at the start. Lets
// heaps grow in steps, of 32 MB where there is plenty.
void cap_memory(std::uint64_t bytes, double untouched = 0.0);

// Largest resident size so far, in bytes.
[[nodiscard]] std::uint64_t peak_memory();

// Bytes that are resident now, with what code and stacks will take yet.
[[nodiscard]] double memory_in_use();

// Throws LimitError with both numbers if `more` bytes on top of memory_in_use() exceed `limit`. `name`: the file
// concerned.
void check_memory(const std::string& name, double more, std::uint64_t limit);

// CPUs by the tightest quota of the cgroup (v1 or v2) of this process and those above it. `root` stands in for "/".
[[nodiscard]] std::optional<double> cgroup_cpus(const std::filesystem::path& root = "/");

// Bytes that these cgroups leave: their limits less what is in use and not reclaimable file cache.
[[nodiscard]] std::optional<std::uint64_t> cgroup_memory(const std::filesystem::path& root = "/");

}  // namespace raycone
