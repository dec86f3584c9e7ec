// Sources: proc(5), getrlimit(2), mallopt(3).
#include "app/process/memory_limit.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <optional>

#include "app/process/cgroups.h"
#include "app/process/kernel_files.h"
#include "core/machine/threads.h"
#include "io/files/file_error.h"
#include "io/files/readable_bytes.h"

namespace raycone {
namespace {

// What a run has yet to touch beside what it allocates: pages of code, and of the stack of each thread
// (docs/robustness.md, "Memory").
constexpr double kUntouchedCode = 6.0 * 1024 * 1024;
constexpr double kUntouchedStack = 128.0 * 1024;

// Others need more memory meanwhile, and a machine without any kills whom it likes.
constexpr double kShareOfMachine = 7.0 / 8.0;

// An entry of /proc/self/status or /proc/meminfo, in bytes.
std::optional<double> proc_bytes(const char* path, const std::string& key) {
  const std::optional<double> kilobytes = number_behind(path, key + ":");
  if (!kilobytes) return std::nullopt;
  return *kilobytes * 1024.0;
}

// As whoever started this process set it: cap_memory() sets others.
rlim_t data_limit_at_start() {
  static const rlim_t at_start = [] {
    rlimit limit{};
    return getrlimit(RLIMIT_DATA, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
  }();
  return at_start;
}

double mapped_data() { return proc_bytes("/proc/self/status", "VmData").value_or(0.0); }

// What may be resident in all where data is limited.
std::optional<double> memory_within_data_limit() {
  if (data_limit_at_start() == RLIM_INFINITY) return std::nullopt;
  return memory_in_use() + std::max(static_cast<double>(data_limit_at_start()) - mapped_data(), 0.0);
}

// By which heaps grow, beyond what is asked of them: the more, the more of it may come in huge pages (memory.cpp). A
// small part of what may be used, since threads have heaps of their own, whose ends count as used; at least what is the
// C library's own choice.
int heap_step(std::uint64_t memory) {
  constexpr std::uint64_t kLeast = std::uint64_t{1} << 17, kMost = std::uint64_t{1} << 25;
  constexpr std::uint64_t kPart = 32;
  return static_cast<int>(std::clamp(memory / kPart / static_cast<std::uint64_t>(thread_count()), kLeast, kMost));
}

std::optional<double> address_space_left() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  const double used = proc_bytes("/proc/self/status", "VmSize").value_or(0.0);
  return std::max(static_cast<double>(limit.rlim_cur) - used, 0.0);
}

}  // namespace

std::uint64_t available_memory(std::uint64_t processes) {
  double bytes = proc_bytes("/proc/meminfo", "MemAvailable").value_or(0x1p62);
  bytes += proc_bytes("/proc/meminfo", "SwapFree").value_or(0.0);
  bytes = std::min(bytes, static_cast<double>(cgroup_memory().value_or(1ULL << 62)));
  bytes = std::min(kShareOfMachine * bytes / static_cast<double>(processes), address_space_left().value_or(0x1p62));
  bytes = std::min(bytes, memory_within_data_limit().value_or(0x1p62));
  return static_cast<std::uint64_t>(bytes);
}

// Resident are files (code), stacks, and of what is mapped privately and can be written (RLIMIT_DATA counts that) the
// part that has been touched.
void cap_memory(std::uint64_t bytes, double untouched) {
  const int step = heap_step(bytes);
  mallopt(M_TOP_PAD, step);
  const rlim_t at_start = data_limit_at_start();
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  const double mapped = mapped_data();
  const double spare = std::min<double>(static_cast<double>(mallinfo2().keepcost), step);  // at the end of the heap
  const double left = std::max(static_cast<double>(bytes) - memory_in_use() - spare, 0.0);
  const double wanted = std::min(mapped + untouched + left, 0x1p62);
  limit.rlim_cur = std::min(static_cast<rlim_t>(wanted), std::min(at_start, limit.rlim_max));
  setrlimit(RLIMIT_DATA, &limit);
}

std::uint64_t peak_memory() {
  return static_cast<std::uint64_t>(proc_bytes("/proc/self/status", "VmHWM").value_or(0.0));
}

double memory_in_use() {
  return proc_bytes("/proc/self/status", "VmRSS").value_or(0.0) + kUntouchedCode + kUntouchedStack * thread_count();
}

void check_memory(const std::string& name, double more, std::uint64_t limit) {
  if (more + memory_in_use() <= static_cast<double>(limit)) return;
  malloc_trim(0);  // what was freed counts as in use as long as the allocator keeps it
  const double needed = more + memory_in_use();
  if (needed <= static_cast<double>(limit)) return;
  const std::string allowed = readable_bytes(static_cast<double>(limit));
  std::string wanted = allowed;  // which would be no reason, as far as its digits tell
  for (double bytes = needed; wanted == allowed; bytes *= 1.02) wanted = readable_bytes(bytes);
  throw LimitError(name + ": needs about " + wanted + " of memory, but the limit is " + allowed);
}

}  // namespace raycone
