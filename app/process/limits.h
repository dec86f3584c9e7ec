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

// The least of: what `ulimit -v` leaves to this process, what `ulimit -d` does, and seven eighths of what the machine
// and the cgroup leave to so many processes, divided among them. Bytes.
[[nodiscard]] std::uint64_t available_memory(std::uint64_t processes = 1);

// Makes allocations fail with std::bad_alloc before more than `bytes` are resident in this process, code and libraries
// included. What is mapped at the time of the call and was never touched, such as stacks of threads that run, is taken
// to stay so, but for the end of the heap; so are `untouched` bytes that are yet to be mapped. Never more than
// `ulimit -d` allowed at the start. Lets heaps grow in steps, of 32 MB each where there is plenty, of less with many
// threads.
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
