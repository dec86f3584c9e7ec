// Sources: cgroups(7), Linux's admin-guide/cgroup-v2 and cgroup-v1/memory.
#include "app/process/cgroups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include "app/process/kernel_files.h"
#include "app/text/parse_value.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

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

// Where a version of cgroups tells of memory.
struct MemoryFiles {
  const char* limit;
  const char* usage;
  std::string prefix;  // of the statistics that count what is below, too
};

// Bytes that one cgroup leaves.
std::optional<double> memory_left_by(const fs::path& group) {
  const MemoryFiles version_2{"memory.max", "memory.current", ""};
  const MemoryFiles version_1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_"};
  for (const MemoryFiles& files : {version_2, version_1}) {
    const std::vector<double> limit = limits_in(group / files.limit);
    if (limit.empty()) continue;
    const std::vector<double> usage = limits_in(group / files.usage);
    const fs::path statistics = group / "memory.stat";
    const double cache = number_behind(statistics, files.prefix + "inactive_file").value_or(0.0) +
                         number_behind(statistics, files.prefix + "active_file").value_or(0.0);
    const double used = usage.empty() ? 0.0 : std::max(usage[0] - cache, 0.0);
    return std::max(limit[0] - used, 0.0);
  }
  return std::nullopt;
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

}  // namespace raycone
