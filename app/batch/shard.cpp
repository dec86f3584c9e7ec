#include "app/batch/shard.h"

#include <algorithm>
#include <numeric>

namespace raycone {

std::vector<std::size_t> part_of(const std::vector<SizedName>& all, const Shard& shard) {
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&all](std::size_t a, std::size_t b) {
    return all[a].size != all[b].size ? all[a].size > all[b].size : all[a].name < all[b].name;
  });
  std::vector<std::size_t> part;
  for (std::size_t i = shard.index - 1; i < order.size(); i += shard.count) part.push_back(order[i]);
  std::ranges::sort(part);
  return part;
}

}  // namespace raycone
