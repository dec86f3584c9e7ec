#include "core/weld.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>

#include "core/buckets.h"
#include "core/threads.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::uint64_t mix(std::uint64_t h, std::uint64_t value) {
  h = (h ^ value) * 0x9E3779B97F4A7C15ULL;
  return h ^ (h >> 29);
}

std::uint64_t hash(const Vec3& p, std::uint64_t seed = 0) {
  std::uint64_t h = mix(seed, std::bit_cast<std::uint64_t>(p.x));
  h = mix(h, std::bit_cast<std::uint64_t>(p.y));
  return mix(h, std::bit_cast<std::uint64_t>(p.z));
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::bit_cast<std::uint64_t>(a.x) == std::bit_cast<std::uint64_t>(b.x) &&
         std::bit_cast<std::uint64_t>(a.y) == std::bit_cast<std::uint64_t>(b.y) &&
         std::bit_cast<std::uint64_t>(a.z) == std::bit_cast<std::uint64_t>(b.z);
}

Vec3 with_positive_zeros(const Vec3& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

struct HashedVertex {
  std::uint64_t hash;
  std::uint32_t index;
};

// Sets first[i] of the vertices of one bucket to the smallest index of a vertex of the same hash. Buckets hold all
// vertices of a hash, by increasing index.
void find_first(std::span<const HashedVertex> bucket, std::vector<std::uint32_t>& first) {
  const std::size_t slots = std::bit_ceil(bucket.size() + bucket.size() / 2 + 1);
  std::vector<std::uint32_t> table(slots, kNone);  // places in the bucket; open addressing
  for (std::uint32_t place = 0; place < bucket.size(); ++place) {
    const HashedVertex& vertex = bucket[place];
    std::size_t slot = vertex.hash & (slots - 1);
    while (table[slot] != kNone && bucket[table[slot]].hash != vertex.hash) slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) table[slot] = place;
    first[vertex.index] = bucket[table[slot]].index;
  }
}

// For each vertex the index of the first one of the same hash. The vertices themselves stay untouched meanwhile: they
// are far apart in memory, where those of one hash are found.
std::vector<std::uint32_t> first_of_same_hash(const std::vector<Vec3>& vertices, std::uint64_t seed) {
  constexpr std::size_t kBucket = 4096;  // vertices: its table fits the second-level cache
  constexpr std::size_t kMaxBuckets = 4096;
  const std::size_t count = std::min(std::bit_ceil(vertices.size() / kBucket + 1), kMaxBuckets);
  const Buckets<HashedVertex> buckets(vertices.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t h = hash(vertices[i], seed);
      emit((h >> 40) & (count - 1), HashedVertex{h, static_cast<std::uint32_t>(i)});
    }
  });
  std::vector<std::uint32_t> first(vertices.size());
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) find_first(buckets[n], first);
  });
  return first;
}

// For each vertex the index of the first bitwise equal one.
std::vector<std::uint32_t> first_equal(const std::vector<Vec3>& vertices) {
  for (std::uint64_t seed = 0;; ++seed) {
    std::vector<std::uint32_t> first = first_of_same_hash(vertices, seed);
    std::atomic<bool> collision = false;
    parallel_for(vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!same_bits(vertices[i], vertices[first[i]])) collision = true;
      }
    });
    if (!collision) return first;
  }
}

// Keeps the first of bitwise equal vertices, in their order. Returns for each vertex the one that stands for it.
std::vector<std::uint32_t> weld_exactly(std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> representative = first_equal(vertices);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (representative[i] == i) {
      vertices[kept] = vertices[i];
      representative[i] = kept++;
    } else {
      representative[i] = representative[representative[i]];
    }
  }
  vertices.resize(kept);
  return representative;
}

// Representatives in cubic cells of the welding distance: all within that distance of a point lie in 27 cells.
class RepresentativeGrid {
 public:
  explicit RepresentativeGrid(double distance) : distance_(distance) {}

  // The earliest representative within the distance, or kNone.
  [[nodiscard]] std::uint32_t find(const std::vector<Vec3>& vertices, const Vec3& p) const {
    std::uint32_t earliest = kNone;
    for (double dx = -1; dx <= 1; ++dx) {
      for (double dy = -1; dy <= 1; ++dy) {
        for (double dz = -1; dz <= 1; ++dz) {
          const auto [begin, end] = cells_.equal_range(hash(cell(p) + Vec3{dx, dy, dz}));
          for (auto it = begin; it != end; ++it) {
            if (near(vertices[it->second], p)) earliest = std::min(earliest, it->second);
          }
        }
      }
    }
    return earliest;
  }
  void insert(const Vec3& p, std::uint32_t index) { cells_.emplace(hash(cell(p) + Vec3{}), index); }

 private:
  [[nodiscard]] Vec3 cell(const Vec3& p) const {
    return {std::floor(p.x / distance_), std::floor(p.y / distance_), std::floor(p.z / distance_)};
  }
  [[nodiscard]] bool near(const Vec3& a, const Vec3& b) const {
    const Vec3 d = a - b;
    return std::hypot(d.x, d.y, d.z) <= distance_;
  }

  double distance_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

std::vector<std::uint32_t> weld_by_distance(std::vector<Vec3>& vertices, double distance) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return lexicographic_order(vertices[i], vertices[j]) < 0; });
  std::vector<Vec3> representatives;
  std::vector<std::uint32_t> representative(vertices.size());
  RepresentativeGrid grid(distance);
  for (const std::uint32_t i : order) {
    std::uint32_t found = grid.find(representatives, vertices[i]);
    if (found == kNone) {
      found = static_cast<std::uint32_t>(representatives.size());
      grid.insert(vertices[i], found);
      representatives.push_back(vertices[i]);
    }
    representative[i] = found;
  }
  vertices = std::move(representatives);
  return representative;
}

}  // namespace

TriangleMesh weld(TriangleMesh mesh, const Weld& how) {
  for (Vec3& p : mesh.vertices) p = with_positive_zeros(p);
  if (how.mode == WeldMode::kNone) return mesh;
  std::vector<std::uint32_t> representative = weld_exactly(mesh.vertices);
  if (how.mode == WeldMode::kDistance) {
    const std::vector<std::uint32_t> nearer = weld_by_distance(mesh.vertices, how.distance);
    for (std::uint32_t& r : representative) r = nearer[r];
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = representative[v];
  }
  return mesh;
}

}  // namespace raycone
