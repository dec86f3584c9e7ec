#include "core/orientation/unique_faces.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/machine/buckets.h"
#include "core/machine/sorted_by_key.h"
#include "core/machine/threads.h"

namespace raycone {
namespace {

// Filed by the lowest of its corners.
struct FiledFace {
  std::uint32_t lowest, middle, highest;
  std::uint32_t face;

  [[nodiscard]] auto key() const { return std::array{lowest, middle, highest}; }
  friend bool operator<(const FiledFace& a, const FiledFace& b) {
    return std::pair(a.key(), a.face) < std::pair(b.key(), b.face);
  }
};

constexpr int kVerticesPerBucketLog2 = 9;  // few enough for a bucket to stay in a cache while it is sorted

// Whether the corners, three different numbers, are in rising order but for a rotation.
bool rises(const Triangle& t) { return ((t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0])) == 2; }

// A counting sort by the lowest corner; few faces share it nearly always.
void sort_by_corners(std::span<FiledFace> bucket) {
  constexpr std::size_t kVertices = std::size_t{1} << kVerticesPerBucketLog2;
  SortedByKey<FiledFace> sorted(kVertices, [&](const auto& emit) {
    for (const FiledFace& f : bucket) emit(f.lowest % kVertices, f);
  });
  for (std::size_t v = 0; v < kVertices; ++v) std::sort(sorted[v].begin(), sorted[v].end());
  std::ranges::copy(sorted.all(), bucket.begin());
}

struct SameFaces {
  std::uint32_t first, face;  // places in the mesh
};

// Each repeated face with the first one of its positions, those too; by first, then face, in a bucket.
void add_repeated(std::span<FiledFace> bucket, std::vector<SameFaces>& repeated) {
  if (bucket.size() > 1) sort_by_corners(bucket);
  for (auto it = bucket.begin(); it != bucket.end();) {
    const auto end = std::find_if(it, bucket.end(), [&](const FiledFace& f) { return f.key() != it->key(); });
    if (end - it > 1) {
      for (auto copy = it; copy != end; ++copy) repeated.push_back({it->face, copy->face});
    }
    it = end;
  }
}

// Per vertex 1 where faces that have it as their lowest corner may be the same, which marks tell: four bits of 64.
std::vector<std::uint8_t> may_repeat(const std::vector<Triangle>& corners, std::size_t vertices) {
  std::vector<std::uint64_t> marks(vertices, 0);
  std::vector<std::uint8_t> repeats(vertices, 0);
  for (const Triangle& t : corners) {
    const std::uint32_t lowest = std::min(std::min(t[0], t[1]), t[2]);
    // The same in any order of corners.
    const auto square = [](std::uint64_t v) { return v * v; };
    const std::uint64_t hash = (square(t[0]) + square(t[1]) + square(t[2])) * 0x9E3779B97F4A7C15U;
    std::uint64_t mark = 0;
    for (const int shift : {58, 52, 46, 40}) mark |= std::uint64_t{1} << (hash >> shift & 63);
    repeats[lowest] |= static_cast<std::uint8_t>((~marks[lowest] & mark) == 0);
    marks[lowest] |= mark;
  }
  return repeats;
}

std::vector<SameFaces> repeated_faces(const std::vector<Triangle>& corners, std::size_t vertices) {
  const std::vector<std::uint8_t> repeats = may_repeat(corners, vertices);
  const std::size_t count = (vertices >> kVerticesPerBucketLog2) + 1;
  const Buckets<FiledFace> buckets(corners.size(), count, [&](std::size_t begin, std::size_t end, auto emit) {
    for (std::size_t i = begin; i < end; ++i) {
      Triangle t = corners[i];
      if (repeats[std::min(std::min(t[0], t[1]), t[2])] == 0 || is_collapsed(t)) continue;
      std::sort(t.begin(), t.end());
      emit(t[0] >> kVerticesPerBucketLog2, FiledFace{t[0], t[1], t[2], static_cast<std::uint32_t>(i)});
    }
  });
  std::vector<std::vector<SameFaces>> parts(count);
  parallel_for_each(count, [&](std::size_t n) { add_repeated(buckets[n], parts[n]); });
  std::vector<SameFaces> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end(), [](const SameFaces& a, const SameFaces& b) {
    return std::pair(a.first, a.face) < std::pair(b.first, b.face);
  });
  return all;
}

}  // namespace

UniqueFaces unique_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& position) {
  std::vector<Triangle> corners = mesh.triangles;
  for (Triangle& t : corners) t = {position[t[0]], position[t[1]], position[t[2]]};
  const std::vector<SameFaces> repeated = repeated_faces(corners, mesh.vertices.size());
  std::vector<bool> is_copy(corners.size(), false);
  for (const SameFaces& same : repeated) is_copy[same.face] = same.face != same.first;

  UniqueFaces unique;
  unique.first.reserve(corners.size());
  auto next = repeated.begin();
  for (std::uint32_t face = 0; face < corners.size(); ++face) {
    if (is_copy[face] || is_collapsed(corners[face])) continue;
    const auto index = static_cast<std::uint32_t>(unique.first.size());
    int votes = 1;
    for (bool is_first = true; next != repeated.end() && next->first == face; ++next, is_first = false) {
      const bool as_first = rises(corners[next->face]) == rises(corners[face]);
      if (!is_first) votes += as_first ? 1 : -1;
      unique.copies.push_back({index, next->face, as_first});
    }
    unique.first.push_back(face);
    unique.vote.push_back(static_cast<std::int8_t>((votes > 0) - (votes < 0)));
  }
  unique.corners.reserve(unique.first.size());
  for (const std::uint32_t face : unique.first) unique.corners.push_back(corners[face]);
  return unique;
}

}  // namespace raycone
