// Numbers in sets that are joined one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace raycone {

// Sets of the numbers from 0 on, at first each a set of its own. Number: std::uint32_t or std::size_t. For one thread.
template <class Number = std::uint32_t>
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t numbers) : count_(numbers), parent_(numbers) {
    std::iota(parent_.begin(), parent_.end(), Number{0});
  }

  // How many sets there are.
  [[nodiscard]] std::size_t count() const { return count_; }

  void prefetch(Number n) const { __builtin_prefetch(&parent_[n], 1); }

  // Makes one set of those of a and b.
  void join(Number a, Number b) {
    if (parent_[a] == parent_[b]) return;
    const Number i = lowest(a), j = lowest(b);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --count_;
  }

  // The lowest number of the set of n: equal for two numbers just if they are in one set.
  [[nodiscard]] Number lowest(Number n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }

  // 0, 1 ... for the sets by their lowest numbers, of each number for which is_used(number); `unused` for the others.
  // Precondition: that is the same for all numbers of a set.
  template <class IsUsed>
  [[nodiscard]] std::vector<std::uint32_t> indices(const IsUsed& is_used, std::uint32_t unused) const {
    std::vector<std::uint32_t> indices(parent_.size(), unused);
    std::uint32_t next = 0;
    for (std::size_t n = 0; n < parent_.size(); ++n) {
      if (is_used(n)) indices[n] = parent_[n] == n ? next++ : indices[parent_[n]];
    }
    return indices;
  }
  [[nodiscard]] std::vector<std::uint32_t> indices() const {
    return indices([](std::size_t) { return true; }, 0);
  }

 private:
  std::size_t count_;
  std::vector<Number> parent_;  // one of the same set, never higher than the number
};

}  // namespace raycone
