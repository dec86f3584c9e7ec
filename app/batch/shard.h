// Parts of a batch for several processes or machines.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/options/batch_command.h"

namespace raycone {

struct SizedName {
  std::string name;
  std::uint64_t size = 0;  // bytes
};

// The positions in `all` of those that belong to `shard`, increasing. Sorted by size descending, then name, they are
// dealt out in turn: the assignment depends on nothing else.
[[nodiscard]] std::vector<std::size_t> part_of(const std::vector<SizedName>& all, const Shard& shard);

}  // namespace raycone
