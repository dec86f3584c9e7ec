// What a walk over the triangles of a mesh can note at their vertices while they are at hand in a cache.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// For each vertex a lower one that a triangle joins it to; and the vertices at which two triangles may be the same but
// for their orientation. That is enough to find components and faces that cancel at little cost later (components.h,
// opposite_faces.h). exterior_edges() notes all triangles.
class VertexLinks {
 public:
  // Nothing noted yet.
  explicit VertexLinks(std::size_t vertices) : lower_(vertices, kNone) {}

  static std::uint32_t lowest_of(const Triangle& t) { return lower_of(lower_of(t[0], t[1]), t[2]); }
  // By a mask: a branch on what the order of a mesh makes a coin toss is slow.
  static std::uint32_t lower_of(std::uint32_t a, std::uint32_t b) {
    return b ^ ((a ^ b) & (0U - static_cast<std::uint32_t>(a < b)));
  }

  // A triangle joins these vertices; several threads may say so. Precondition: lowest < v.
  void join(std::uint32_t lowest, std::uint32_t v) {
    // Each choice is a right one.
    std::atomic_ref(lower_[v]).store(lowest, std::memory_order_relaxed);
  }
  // A triangle uses it; several threads may say so.
  void use(std::uint32_t v) {
    const std::atomic_ref lower(lower_[v]);
    std::uint32_t none = kNone;
    // Mostly it is known already, and a look costs less than an exchange.
    if (lower.load(std::memory_order_relaxed) == kNone) {
      lower.compare_exchange_strong(none, v, std::memory_order_relaxed);
    }
  }
  // The lowest vertices of triangles of which an earlier one may have the same three vertices, in any order.
  void add_twins(const std::vector<std::uint32_t>& lowest) {
    twins_.insert(twins_.end(), lowest.begin(), lowest.end());
  }

  // Whether a triangle uses it.
  [[nodiscard]] bool is_used(std::size_t v) const { return lower_[v] != kNone; }
  // v itself where no triangle is noted that joins it to a lower one.
  [[nodiscard]] std::uint32_t lower(std::size_t v) const { return lower_[v]; }
  // Triangles of the same three vertices have their lowest one here, which may come several times.
  [[nodiscard]] const std::vector<std::uint32_t>& twins() const { return twins_; }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  std::vector<std::uint32_t> lower_;
  std::vector<std::uint32_t> twins_;
};

}  // namespace raycone
