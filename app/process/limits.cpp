// Sources: cgroups(7), Linux's admin-guide/cgroup-v2 and cgroup-v1/memory, proc(5), sched_getaffinity(2).
#include "app/process/limits.h"

#include <malloc.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include "app/process/usage_error.h"
#include "app/text/parse_value.h"
#include "core/machine/threads.h"
#include "io/files/file_error.h"
#include "io/files/readable_bytes.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// What a run has yet to touch beside what it allocates: pages of code, and of the stack of each thread
// (docs/robustness.md, "Memory").
constexpr double kUntouchedCode = 6.0 * 1024 * 1024;
constexpr double kUntouchedStack = 128.0 * 1024;

// Others need more memory meanwhile, and a machine without any kills whom it likes.
constexpr double kShareOfMachine = 7.0 / 8.0;

// The directories of this process's cgroups and of all above them, for a v1 controller ("cpu", "memory") or v2. Inside
// a container the path may be one of the host that is not mounted here; its ancestors, in the end the mount, are.
std::vector<fs::path> cgroup_directories(const fs::path& root, const std::string& controller) {
  std::vector<fs::path> directories;
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // "hierarchy:controllers:path"
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool unified = controllers == ",,";
    if (!unified && controllers.find("," + controller + ",") == std::string::npos) continue;
    const fs::path mount = root / "sys/fs/cgroup" / (unified ? "" : controller);
    fs::path below = fs::path(line.substr(second + 1)).lexically_normal().relative_path();
    for (; !below.empty(); below = below.parent_path()) directories.push_back(mount / below);
    directories.push_back(mount);
    if (unified) directories.push_back(mount / "unified");
  }
  return directories;
}

// The numbers at the start of a one-line file; "max" and negative numbers mean "no limit": nothing.
std::vector<double> limits_in(const fs::path& path) {
  std::vector<double> numbers;
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    const std::optional<double> number = number_from(word);
    if (!number || *number < 0.0) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// Value of `key` in lines "key value" or "key: value kB", in the file's unit.
std::optional<double> entry(const fs::path& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    std::string value;
    words >> name >> value;
    if (name == key) return number_from(value);
  }
  return std::nullopt;
}

// An entry of /proc/self/status or /proc/meminfo, in bytes.
std::optional<double> proc_bytes(const char* path, const std::string& key) {
  const std::optional<double> kilobytes = entry(path, key + ":");
  if (!kilobytes) return std::nullopt;
  return *kilobytes * 1024.0;
}

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

// Bytes that one cgroup leaves.
std::optional<double> memory_left_by(const fs::path& group) {
  for (const bool v2 : {true, false}) {
    const std::vector<double> limit = limits_in(group / (v2 ? "memory.max" : "memory.limit_in_bytes"));
    const std::vector<double> usage = limits_in(group / (v2 ? "memory.current" : "memory.usage_in_bytes"));
    if (limit.empty()) continue;
    const std::string prefix = v2 ? "" : "total_";
    const fs::path statistics = group / "memory.stat";
    const double cache = entry(statistics, prefix + "inactive_file").value_or(0.0) +
                         entry(statistics, prefix + "active_file").value_or(0.0);
    const double used = usage.empty() ? 0.0 : std::max(usage[0] - cache, 0.0);
    return std::max(limit[0] - used, 0.0);
  }
  return std::nullopt;
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

std::optional<double> cgroup_cpus(const fs::path& root) {
  std::optional<double> cpus;
  for (const fs::path& group : cgroup_directories(root, "cpu")) {
    std::vector<double> quota = limits_in(group / "cpu.max");  // v2: "quota period", microseconds
    if (quota.size() != 2) {
      quota = limits_in(group / "cpu.cfs_quota_us");
      const std::vector<double> period = limits_in(group / "cpu.cfs_period_us");
      quota.insert(quota.end(), period.begin(), period.end());
    }
    if (quota.size() != 2 || !(quota[1] > 0.0)) continue;
    cpus = std::min(cpus.value_or(HUGE_VAL), quota[0] / quota[1]);
  }
  return cpus;
}

std::optional<std::uint64_t> cgroup_memory(const fs::path& root) {
  std::optional<double> left;
  for (const fs::path& group : cgroup_directories(root, "memory")) {
    if (const std::optional<double> bytes = memory_left_by(group)) left = std::min(left.value_or(HUGE_VAL), *bytes);
  }
  if (!left || *left >= 0x1p62) return std::nullopt;  // v1 writes "no limit" as about 2^63
  return static_cast<std::uint64_t>(*left);
}

int default_threads() {
  if (const char* const text = std::getenv("RAYCONE_THREADS"); text && *text) {
    const std::optional<std::int64_t> count = integer_from(text);
    if (count && *count >= 1 && *count <= kMaxThreads) return static_cast<int>(*count);
    throw UsageError(std::string("RAYCONE_THREADS=") + text + ": expected 1 to " + std::to_string(kMaxThreads));
  }
  const double quota = std::ceil(cgroup_cpus().value_or(kMaxThreads));
  return static_cast<int>(std::clamp<double>(quota, 1.0, std::min(affinity_cpus(), kMaxThreads)));
}

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
  std::string wanted = readable_bytes(needed);
  constexpr double kMore = 1.02;
  if (wanted == allowed) wanted = readable_bytes(kMore * needed);
  throw LimitError(name + ": needs about " + wanted + " of memory, but the limit is " + allowed);
}

}  // namespace raycone
