#include "core/weld.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace raycone {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::uint64_t mix(std::uint64_t h, std::uint64_t value) {
  h = (h ^ value) * 0x9E3779B97F4A7C15ULL;
  return h ^ (h >> 29);
}

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = mix(0, std::bit_cast<std::uint64_t>(p.x));
  h = mix(h, std::bit_cast<std::uint64_t>(p.y));
  return mix(h, std::bit_cast<std::uint64_t>(p.z));
}

bool same_bits(const Vec3& a, const Vec3& b) {
  return std::bit_cast<std::uint64_t>(a.x) == std::bit_cast<std::uint64_t>(b.x) &&
         std::bit_cast<std::uint64_t>(a.y) == std::bit_cast<std::uint64_t>(b.y) &&
         std::bit_cast<std::uint64_t>(a.z) == std::bit_cast<std::uint64_t>(b.z);
}

Vec3 with_positive_zeros(const Vec3& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

// For each vertex the index of the first bitwise equal one, renumbered in order of first appearance.
std::vector<std::uint32_t> weld_exactly(std::vector<Vec3>& vertices) {
  const std::size_t slots = std::bit_ceil(2 * vertices.size() + 1);
  std::vector<std::uint32_t> table(slots, kNone);  // open addressing: representatives
  std::vector<std::uint32_t> representative(vertices.size());
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::size_t slot = hash(vertices[i]) & (slots - 1);
    while (table[slot] != kNone && !same_bits(vertices[table[slot]], vertices[i])) slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) {
      table[slot] = count;
      vertices[count++] = vertices[i];  // count <= i: never overwrites a vertex not yet seen
    }
    representative[i] = table[slot];
  }
  vertices.resize(count);
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

TriangleMesh weld(const TriangleMesh& mesh, const Weld& how) {
  TriangleMesh welded = mesh;
  for (Vec3& p : welded.vertices) p = with_positive_zeros(p);
  if (how.mode == WeldMode::kNone) return welded;
  std::vector<std::uint32_t> representative = weld_exactly(welded.vertices);
  if (how.mode == WeldMode::kDistance) {
    const std::vector<std::uint32_t> nearer = weld_by_distance(welded.vertices, how.distance);
    for (std::uint32_t& r : representative) r = nearer[r];
  }
  for (Triangle& triangle : welded.triangles) {
    for (std::uint32_t& v : triangle) v = representative[v];
  }
  return welded;
}

}  // namespace raycone
