// Items put in the order of small whole numbers: a stable counting sort on one thread. Where there are few keys and
// many items, Buckets does it on all threads.
#pragma once

#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace raycone {

// `Count` holds the number of items. Const calls may run concurrently.
template <class Item, class Count = std::size_t>
class SortedByKey {
 public:
  // No keys.
  SortedByKey() = default;

  // produce(emit) makes the items by emit(key, item), key < keys, the same ones both times that it is called. Items of
  // a key keep their order.
  template <class Produce>
  SortedByKey(std::size_t keys, const Produce& produce) : begin_(keys + 2, 0) {
    produce([&](std::size_t key, const Item&) { ++begin_[key + 2]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    items_.resize(begin_.back());
    // begin_[key + 1] is where the key's next item goes: when all are there, its end.
    produce([&](std::size_t key, const Item& item) { items_[begin_[key + 1]++] = item; });
    begin_.pop_back();
  }

  [[nodiscard]] std::size_t keys() const { return begin_.empty() ? 0 : begin_.size() - 1; }

  // The items of one key.
  [[nodiscard]] std::span<Item> operator[](std::size_t key) {
    return {items_.data() + begin_[key], items_.data() + begin_[key + 1]};
  }
  [[nodiscard]] std::span<const Item> operator[](std::size_t key) const {
    return {items_.data() + begin_[key], items_.data() + begin_[key + 1]};
  }

  // How many items have lower keys: the place of the key's first one in all(). key <= keys().
  [[nodiscard]] std::size_t before(std::size_t key) const { return begin_[key]; }
  [[nodiscard]] std::span<const Item> all() const { return items_; }
  // Takes all of them out.
  [[nodiscard]] std::vector<Item> release() && { return std::move(items_); }

 private:
  std::vector<Count> begin_;  // per key, and the end
  std::vector<Item> items_;
};

}  // namespace raycone
