#include "core/mesh/equal_vertices.h"

#include <sys/random.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <limits>
#include <memory>
#include <span>

#include "core/machine/buckets.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::bit_cast<std::uint64_t>(a.x) == std::bit_cast<std::uint64_t>(b.x) &&
         std::bit_cast<std::uint64_t>(a.y) == std::bit_cast<std::uint64_t>(b.y) &&
         std::bit_cast<std::uint64_t>(a.z) == std::bit_cast<std::uint64_t>(b.z);
}

struct HashedVertex {
  std::uint64_t hash;
  std::uint32_t index;
};

// Sets first[i] of the vertices of one bucket to the index of the first one that is the same. Buckets hold all vertices
// of a hash, by increasing index. Slots hold chains: how long they are is bounded by how likely pairs collide, which is
// not true of open addressing.
template <class Same>
void find_first(std::span<const HashedVertex> bucket, const Same& same, std::vector<std::uint32_t>& first) {
  const std::size_t slots = std::bit_ceil(bucket.size() + 1);
  std::vector<std::uint32_t> newest(slots, kNone);  // of a slot, as its index in the bucket
  // Of the same slot as the one at this index.
  const auto older = std::make_unique_for_overwrite<std::uint32_t[]>(bucket.size());
  for (std::uint32_t i = 0; i < bucket.size(); ++i) {
    std::uint32_t& slot = newest[bucket[i].hash & (slots - 1)];
    std::uint32_t found = slot;
    while (found != kNone && !same(bucket[found], bucket[i])) found = older[found];
    if (found == kNone) {
      older[i] = slot;
      slot = found = i;
    }
    first[bucket[i].index] = bucket[found].index;
  }
}

template <class Same>
void find_first(const Buckets<HashedVertex>& buckets, const Same& same, std::vector<std::uint32_t>& first) {
  parallel_for_each(buckets.count(), [&](std::size_t n) { find_first(buckets[n], same, first); });
}

bool all_equal(const std::vector<Vec3>& vertices, const std::vector<std::uint32_t>& first) {
  constexpr std::size_t kVerticesPerTask = 4096;
  std::atomic<bool> equal = true;
  parallel_for_each(vertices.size(), kVerticesPerTask, [&](std::size_t i) {
    if (!same_bits(vertices[i], vertices[first[i]])) equal = false;
  });
  return equal;
}

}  // namespace

VertexHash::VertexHash() : key_{} {
  // Refused by kernels before 3.17 and by some sandboxes: the key is known then, and only the time is at stake.
  if (getrandom(key_.data(), sizeof key_, GRND_NONBLOCK) == static_cast<ssize_t>(sizeof key_)) return;
  constexpr std::array<std::uint64_t, 8> kDigits{// of pi
                                                 0x243F6A8885A308D3, 0x13198A2E03707344, 0xA4093822299F31D0,
                                                 0x082EFA98EC4E6C89, 0x452821E638D01377, 0xBE5466CF34E90C6C,
                                                 0xC0AC29B7C97C50DD, 0x3F84D5B5B5470917};
  for (std::size_t i = 0; i < key_.size(); ++i) {
    key_[i] = static_cast<unsigned __int128>(kDigits[2 * i]) << 64 | kDigits[2 * i + 1];
  }
}

std::uint64_t VertexHash::operator()(const Vec3& p) const {
  const unsigned __int128 sum = key_[0] + key_[1] * std::bit_cast<std::uint64_t>(p.x) +
                                key_[2] * std::bit_cast<std::uint64_t>(p.y) +
                                key_[3] * std::bit_cast<std::uint64_t>(p.z);
  return static_cast<std::uint64_t>(sum >> 64);
}

// By their hashes, and then a look whether the vertices are equal, too: vertices of one hash are far apart in memory
// while a bucket is worked on, but mostly near each other in the order of the mesh. That one hash stands for two
// different vertices is nearly never seen, and then each is looked at where its hash is met.
std::vector<std::uint32_t> first_equal_vertices(const std::vector<Vec3>& vertices, const VertexHash& hash) {
  assert(vertices.size() <= kNone);
  constexpr std::size_t kBucket = 4096;  // vertices: its table fits the second-level cache
  constexpr std::size_t kMaxBuckets = 4096;
  const std::size_t count = std::min(std::bit_ceil(vertices.size() / kBucket + 1), kMaxBuckets);
  const Buckets<HashedVertex> buckets(vertices.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t h = hash(vertices[i]);
      emit((h >> 40) & (count - 1), HashedVertex{h, static_cast<std::uint32_t>(i)});
    }
  });
  std::vector<std::uint32_t> first(vertices.size());
  const auto same_hash = [](const HashedVertex& a, const HashedVertex& b) { return a.hash == b.hash; };
  find_first(buckets, same_hash, first);
  if (all_equal(vertices, first)) return first;
  find_first(
      buckets,
      [&](const HashedVertex& a, const HashedVertex& b) {
        return same_hash(a, b) && same_bits(vertices[a.index], vertices[b.index]);
      },
      first);
  return first;
}

}  // namespace raycone
