#include "core/surface/merge_planes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "core/machine/threads.h"

namespace raycone {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF, kUnmet = 0xFFFFFFFE;
constexpr std::size_t kFacesPerTask = 4096;

// The numbers of faces by brick, and of each vertex the brick that has all of its faces.
struct Bricks {
  std::vector<std::uint32_t> faces;
  std::vector<std::size_t> begin;    // of each brick's in `faces`; one more at the end
  std::vector<std::uint32_t> owner;  // kNone where several bricks have faces there; kUnmet where none has
};

// Sorts few numbers below 2^33 sooner than comparisons do: digit by digit, the lowest first.
void sort_numbers(std::vector<std::uint32_t>& numbers, std::vector<std::uint32_t>& spare) {
  constexpr unsigned kDigit = 11;
  constexpr std::size_t kWorthIt = 1024;
  if (numbers.size() < kWorthIt) {
    std::ranges::sort(numbers);
    return;
  }
  spare.resize(numbers.size());
  for (unsigned shift = 0; shift < 32; shift += kDigit) {
    std::array<std::uint32_t, (1U << kDigit) + 1> next{};
    for (const std::uint32_t n : numbers) ++next[(n >> shift & ((1U << kDigit) - 1)) + 1];
    for (std::size_t digit = 1; digit < next.size(); ++digit) next[digit] += next[digit - 1];
    for (const std::uint32_t n : numbers) spare[next[n >> shift & ((1U << kDigit) - 1)]++] = n;
    numbers.swap(spare);
  }
}

class BrickMerger {
 public:
  BrickMerger(const SurfaceMesh& surface, const TriangleMesh& input, const Lattice& lattice,
              const std::vector<bool>& kept, const MergeLimits& limits)
      : vertices_(surface.mesh.vertices),
        input_(input),
        lattice_(lattice),
        kept_(kept),
        limits_(limits),
        merged_{surface.mesh.triangles, surface.sources, {}},
        settled_(surface.mesh.vertices.size(), 0) {
    merged_.into.resize(vertices_.size());
    std::iota(merged_.into.begin(), merged_.into.end(), 0U);
  }

  // A brick's faces fit into the cache, and threads share bricks. What is at their borders is merged in other bricks,
  // shifted by half of one; then what is left, as a whole.
  MergedFaces merge() {
    constexpr std::array kShifts{0.0, 0.5};
    for (const double shift : kShifts) merge_all(bricks(shift));
    merge_all(one_brick());
    for (std::uint32_t& target : merged_.into) {
      while (merged_.into[target] != target) target = merged_.into[target];
    }
    return std::move(merged_);
  }

 private:
  static constexpr double kSide = 32.0;  // voxels

  // Bricks along an axis, whether they are shifted or not.
  [[nodiscard]] std::int64_t bricks_along(int axis) const {
    return static_cast<std::int64_t>(static_cast<double>(lattice_.counts[static_cast<std::size_t>(axis)]) / kSide) + 2;
  }

  // The place of the brick of a point in all of the lattice's, x fastest.
  [[nodiscard]] std::uint32_t brick_at(const Vec3& p, double shift) const {
    std::int64_t place = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double at = (p[axis] - lattice_.coordinate(axis, lattice_.index_min[static_cast<std::size_t>(axis)])) /
                        lattice_.spacing[axis];
      const auto brick = static_cast<std::int64_t>(std::floor(at / kSide + shift));
      place = place * bricks_along(axis) + std::clamp<std::int64_t>(brick, 0, bricks_along(axis) - 1);
    }
    return static_cast<std::uint32_t>(place);
  }

  // A face is in the brick of its first corner. Bricks are in the order of their first faces.
  [[nodiscard]] Bricks bricks(double shift) const {
    std::vector<std::uint32_t> brick_of(merged_.triangles.size());
    parallel_for(brick_of.size(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t face = begin; face < end; ++face) {
        brick_of[face] = brick_at(vertices_[merged_.triangles[face][0]], shift);
      }
    });
    std::vector<std::uint32_t> numbers(static_cast<std::size_t>(bricks_along(0) * bricks_along(1) * bricks_along(2)),
                                       kNone);
    std::uint32_t count = 0;
    for (std::uint32_t& brick : brick_of) {
      std::uint32_t& number = numbers[brick];
      if (number == kNone) number = count++;
      brick = number;
    }
    return sorted(brick_of, count);
  }

  [[nodiscard]] Bricks one_brick() const { return sorted(std::vector<std::uint32_t>(merged_.triangles.size(), 0), 1); }

  [[nodiscard]] Bricks sorted(const std::vector<std::uint32_t>& brick_of, std::size_t count) const {
    Bricks result{std::vector<std::uint32_t>(brick_of.size()), std::vector<std::size_t>(count + 1, 0),
                  std::vector<std::uint32_t>(vertices_.size(), kUnmet)};
    for (const std::uint32_t brick : brick_of) ++result.begin[brick + 1];
    for (std::size_t brick = 0; brick < count; ++brick) result.begin[brick + 1] += result.begin[brick];
    std::vector<std::size_t> next(result.begin.begin(), result.begin.end() - 1);
    for (std::uint32_t face = 0; face < brick_of.size(); ++face) result.faces[next[brick_of[face]]++] = face;
    find_owners(brick_of, result.owner);
    return result;
  }

  // Whoever comes second from another brick finds one there; none takes its place for good.
  void find_owners(const std::vector<std::uint32_t>& brick_of, std::vector<std::uint32_t>& owner) const {
    parallel_for(brick_of.size(), kFacesPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t face = begin; face < end; ++face) {
        for (const std::uint32_t corner : merged_.triangles[face]) {
          const std::atomic_ref of_corner(owner[corner]);
          std::uint32_t known = of_corner.load(std::memory_order_relaxed);
          if (known == kUnmet) of_corner.compare_exchange_strong(known, brick_of[face], std::memory_order_relaxed);
          const bool is_own = known == kUnmet || known == brick_of[face];
          if (!is_own) of_corner.store(kNone, std::memory_order_relaxed);
        }
      }
    });
  }

  void merge_all(const Bricks& bricks) {
    local_.assign(vertices_.size(), kNone);
    parallel_for(bricks.begin.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
      for (auto brick = static_cast<std::uint32_t>(begin); brick < end; ++brick) merge_one(bricks, brick);
    });
    std::size_t left = 0;
    for (std::size_t face = 0; face < merged_.triangles.size(); ++face) {
      const Triangle& t = merged_.triangles[face];
      if (t[0] == t[1]) continue;
      merged_.sources[left] = merged_.sources[face];
      merged_.triangles[left++] = t;
    }
    merged_.triangles.resize(left);
    merged_.sources.resize(left);
  }

  // Bricks change their own faces only, and where their own vertices are pulled.
  void merge_one(const Bricks& bricks, std::uint32_t brick) {
    const auto faces =
        std::span(bricks.faces).subspan(bricks.begin[brick], bricks.begin[brick + 1] - bricks.begin[brick]);
    if (faces.size() > PatchMerger::kMostFaces) return;
    std::vector<std::uint32_t> global;
    const SurfacePatch patch = patch_of(faces, bricks.owner, brick, global);
    PatchMerger merger(patch, input_, limits_);
    merger.merge();
    for (std::size_t n = 0; n < faces.size(); ++n) {
      Triangle t = merger.triangle(n);
      const bool is_gone = t[0] == t[1];
      for (std::uint32_t& corner : t) corner = is_gone ? 0 : global[corner];
      merged_.triangles[faces[n]] = t;
    }
    for (std::uint32_t v = 0; v < global.size(); ++v) {
      if (merger.into()[v] != v) merged_.into[global[v]] = global[merger.into()[v]];
      note_settled(global[v], patch.settled[v] != 0, merger.is_settled(v));
    }
  }

  // Of a vertex with faces in several bricks, each of them may say that these have changed.
  void note_settled(std::uint32_t vertex, bool before, bool is) {
    if (is != before) std::atomic_ref(settled_[vertex]).store(is ? 1 : 0, std::memory_order_relaxed);
  }

  // `global`: the numbers of its vertices, increasing: choices among equals then depend little on where bricks are.
  SurfacePatch patch_of(std::span<const std::uint32_t> faces, const std::vector<std::uint32_t>& owner,
                        std::uint32_t brick, std::vector<std::uint32_t>& global) {
    const auto is_own = [&](std::uint32_t v) { return owner[v] == brick; };
    for (const std::uint32_t face : faces) {
      for (const std::uint32_t v : merged_.triangles[face]) {
        if (is_own(v) && local_[v] != kNone) continue;
        if (is_own(v)) local_[v] = 0;
        global.push_back(v);
      }
    }
    std::vector<std::uint32_t> spare;
    sort_numbers(global, spare);
    global.erase(std::unique(global.begin(), global.end()), global.end());

    SurfacePatch patch;
    patch.vertices.reserve(global.size());
    patch.roles.reserve(global.size());
    patch.settled.reserve(global.size());
    for (std::uint32_t n = 0; n < global.size(); ++n) {
      const std::uint32_t v = global[n];
      if (is_own(v)) local_[v] = n;
      patch.vertices.push_back(vertices_[v]);
      patch.roles.push_back(!is_own(v) ? VertexRole::kForeign : kept_[v] ? VertexRole::kKept : VertexRole::kFree);
      patch.settled.push_back(std::atomic_ref(settled_[v]).load(std::memory_order_relaxed));
    }
    const auto local = [&](std::uint32_t v) {
      if (is_own(v)) return local_[v];
      return static_cast<std::uint32_t>(std::ranges::lower_bound(global, v) - global.begin());
    };
    patch.triangles.reserve(faces.size());
    patch.sources.reserve(faces.size());
    for (const std::uint32_t face : faces) {
      const auto [a, b, c] = merged_.triangles[face];
      patch.triangles.push_back({local(a), local(b), local(c)});
      patch.sources.push_back(merged_.sources[face]);
    }
    return patch;
  }

  const std::vector<Vec3>& vertices_;
  const TriangleMesh& input_;
  const Lattice& lattice_;
  const std::vector<bool>& kept_;
  MergeLimits limits_;
  MergedFaces merged_;
  std::vector<std::uint8_t> settled_;  // of each vertex, what PatchMerger::is_settled() said
  std::vector<std::uint32_t> local_;   // numbers of vertices in the bricks that have all of their faces
};

}  // namespace

MergedFaces merge_planes(const SurfaceMesh& surface, const TriangleMesh& input, const Lattice& lattice,
                         const std::vector<bool>& kept, const MergeLimits& limits) {
  return BrickMerger(surface, input, lattice, kept, limits).merge();
}

}  // namespace raycone
