// Some items of lists that belong together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace raycone {

// Keeps item n of each list, in this order, if keeps(n); that is asked before item n moves. Precondition: the lists are
// as long as each other.
template <class Keeps, class... Item>
void keep_where(const Keeps& keeps, std::vector<Item>&... lists) {
  const std::size_t count = std::min({lists.size()...});
  std::size_t left = 0;
  for (std::size_t n = 0; n < count; ++n) {
    if (!keeps(n)) continue;
    ((lists[left] = lists[n]), ...);
    ++left;
  }
  (lists.resize(left), ...);
}

}  // namespace raycone
