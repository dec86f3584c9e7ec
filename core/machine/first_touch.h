// Large vectors whose memory all threads touch first.
#pragma once

#include <cstddef>
#include <vector>

#include "core/machine/threads.h"

namespace raycone {

// v.resize(size). But the system clears new memory page by page as it is first touched, which takes longer than filling
// it: here all threads share that.
template <class Item>
void resize_on_all_threads(std::vector<Item>& v, std::size_t size) {
  constexpr std::size_t kPage = 4096, kPagesPerTask = 256;
  if (size > v.size()) {
    v.reserve(size);
    const std::size_t begin = v.size() * sizeof(Item), pages = (size * sizeof(Item) - begin) / kPage;
    volatile unsigned char* const bytes = reinterpret_cast<volatile unsigned char*>(v.data()) + begin;
    parallel_for_each(pages, kPagesPerTask, [&](std::size_t page) { bytes[page * kPage] = 0; });
  }
  v.resize(size);
}

template <class Item>
[[nodiscard]] std::vector<Item> sized_on_all_threads(std::size_t size) {
  std::vector<Item> v;
  resize_on_all_threads(v, size);
  return v;
}

}  // namespace raycone
