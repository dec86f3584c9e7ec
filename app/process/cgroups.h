// What the control groups of this process leave it: CPUs and memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace raycone {

// CPUs by the tightest quota of the cgroup (v1 or v2) of this process and those above it; nothing where none has a
// quota. `root` stands in for "/".
[[nodiscard]] std::optional<double> cgroup_cpus(const std::filesystem::path& root = "/");

// Bytes that these cgroups leave: their limits less what is in use and not reclaimable file cache; nothing where none
// has a limit.
[[nodiscard]] std::optional<std::uint64_t> cgroup_memory(const std::filesystem::path& root = "/");

}  // namespace raycone
