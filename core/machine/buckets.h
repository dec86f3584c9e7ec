// A stable distribution of items over buckets on all threads: the first pass of a radix sort, after which each bucket
// fits a cache and can be worked on alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/machine/threads.h"

namespace raycone {

template <class Item>
class Buckets {
 public:
  // produce(begin, end, emit) makes the items of the inputs begin to end - 1 by emit(bucket, item), bucket < count, the
  // same ones however often it is asked. Items of a bucket keep the order of their inputs, for any number of threads.
  template <class Produce>
  Buckets(std::size_t inputs, std::size_t count, const Produce& produce) : begin_(count + 1, 0) {
    const std::size_t size = std::max(kChunk, count);  // so that there are no more places to count than inputs
    const std::size_t chunks = (inputs + size - 1) / size;
    const auto for_each_chunk = [&](const auto& body) {
      parallel_for_each(chunks, [&](std::size_t c) { body(c, c * size, std::min(inputs, (c + 1) * size)); });
    };
    std::vector<std::size_t> places(chunks * count, 0);  // per chunk and bucket: how many items, then where the next is
    for_each_chunk([&](std::size_t c, std::size_t begin, std::size_t end) {
      produce(begin, end, [&](std::size_t bucket, const Item&) { ++places[c * count + bucket]; });
    });
    std::size_t total = 0;
    for (std::size_t bucket = 0; bucket < count; ++bucket) {
      begin_[bucket] = total;
      for (std::size_t c = 0; c < chunks; ++c) total += std::exchange(places[c * count + bucket], total);
    }
    begin_[count] = total;
    items_ = std::make_unique_for_overwrite<Item[]>(total);
    for_each_chunk([&](std::size_t c, std::size_t begin, std::size_t end) {
      produce(begin, end, [&](std::size_t bucket, const Item& item) { items_[places[c * count + bucket]++] = item; });
    });
  }

  [[nodiscard]] std::size_t count() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<Item> operator[](std::size_t bucket) const {
    return {items_.get() + begin_[bucket], begin_[bucket + 1] - begin_[bucket]};
  }
  // The items of all buckets, one bucket after the other.
  [[nodiscard]] std::span<Item> all() const { return {items_.get(), begin_.back()}; }

 private:
  static constexpr std::size_t kChunk = std::size_t{1} << 16;  // inputs at least

  std::vector<std::size_t> begin_;  // per bucket, and the end
  std::unique_ptr<Item[]> items_;
};

}  // namespace raycone
