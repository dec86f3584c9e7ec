#include "core/machine/sorted_by_key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace raycone {
namespace {

struct Numbered {
  std::uint32_t key, number;
  friend bool operator==(const Numbered&, const Numbered&) = default;
};

TEST(SortedByKey, IsAStableSort) {
  constexpr std::uint32_t kKeys = 7;  // the last one has no items
  std::vector<Numbered> items;
  for (std::uint32_t n = 0; n < 100; ++n) items.push_back({n * n % (kKeys - 1), n});
  SortedByKey<Numbered, std::uint32_t> sorted(kKeys, [&](const auto& emit) {
    for (const Numbered& item : items) emit(item.key, item);
  });
  std::ranges::stable_sort(items, {}, &Numbered::key);
  ASSERT_EQ(sorted.keys(), kKeys);
  EXPECT_TRUE(std::ranges::equal(sorted.all(), items));
  std::size_t before = 0;
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    EXPECT_EQ(sorted.before(key), before);
    EXPECT_EQ(sorted[key].size(), static_cast<std::size_t>(std::ranges::count(items, key, &Numbered::key)));
    for (const Numbered& item : sorted[key]) EXPECT_EQ(item.key, key);
    before += sorted[key].size();
  }
  EXPECT_EQ(sorted.before(kKeys), items.size());
  EXPECT_EQ(std::move(sorted).release(), items);
}

TEST(SortedByKey, MayHaveNoItemsAndNoKeys) {
  const SortedByKey<int> none(3, [](const auto&) {});
  EXPECT_EQ(none.keys(), 3U);
  EXPECT_TRUE(none[2].empty());
  EXPECT_EQ(SortedByKey<int>(0, [](const auto&) {}).keys(), 0U);
  EXPECT_EQ(SortedByKey<int>().keys(), 0U);
}

}  // namespace
}  // namespace raycone
