// Parts of a batch for several processes or machines.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raycone {

// The I-th of N disjoint parts, 1 <= I <= N.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
};

// "3/8", or "slurm": the task of the array job that this process runs in, by SLURM_ARRAY_TASK_ID, _MIN, _MAX and
// _STEP. Throws UsageError, also for an array with gaps (_COUNT tells), where the parts would not add up to the whole.
[[nodiscard]] Shard shard_from(const std::string& text);

struct SizedName {
  std::string name;
  std::uint64_t size = 0;  // bytes
};

// The positions in `all` of those that belong to `shard`, increasing. Sorted by size descending, then name, they are
// dealt out in turn: the assignment depends on nothing else.
[[nodiscard]] std::vector<std::size_t> part_of(const std::vector<SizedName>& all, const Shard& shard);

}  // namespace raycone
