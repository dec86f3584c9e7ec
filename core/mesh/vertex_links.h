// What a walk over the triangles of a mesh can note at their vertices while they are at hand in a cache.
#pragma once

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/data/triangle_mesh.h"

namespace raycone {

// For each vertex a lower one that a triangle joins it to; and at the lowest vertex of each triangle 16 bits that tell
// the triangles there apart, nearly always. That is enough to find components and faces that cancel at little cost
// later (components.h, opposite_faces.h).
class VertexLinks {
 public:
  // Nothing noted yet.
  explicit VertexLinks(std::size_t vertices) : lower_(vertices, kNone), signatures_(vertices) {}

  static std::uint32_t lowest_of(const Triangle& t) { return std::min({t[0], t[1], t[2]}); }

  void prefetch(std::uint32_t lowest) const { _mm_prefetch(&signatures_[lowest], _MM_HINT_T0); }

  // Triangles of one lowest vertex must be noted by one thread.
  void note(const Triangle& t, std::uint32_t lowest) {
    const std::uint32_t highest = std::max({t[0], t[1], t[2]}), middle = t[0] + t[1] + t[2] - lowest - highest;
    // Several threads may choose for a vertex; each choice is a right one.
    std::atomic_ref(lower_[middle]).store(lowest, std::memory_order_relaxed);
    std::atomic_ref(lower_[highest]).store(lowest, std::memory_order_relaxed);
    note(signature_of(middle, highest), signatures_[lowest]);
  }

  // Whether a triangle uses it.
  [[nodiscard]] bool is_used(std::size_t v) const { return lower_[v] != kNone || signatures_[v].newest[0] != 0; }
  // v itself where no triangle joins it to a lower one.
  [[nodiscard]] std::uint32_t lower(std::size_t v) const {
    return lower_[v] == kNone ? static_cast<std::uint32_t>(v) : lower_[v];
  }
  // Whether two triangles of this lowest vertex may have the same three vertices.
  [[nodiscard]] bool may_have_twins(std::size_t v) const { return signatures_[v].newest[0] == kTwins; }

 private:
  struct alignas(16) Signatures {
    std::array<std::uint16_t, 8> newest{};  // first; 0: no triangle
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  static constexpr std::uint16_t kTwins = 0xFFFF;  // in all places: two are equal, or there is no place

  // Neither 0 nor kTwins.
  static std::uint16_t signature_of(std::uint32_t middle, std::uint32_t highest) {
    const std::uint64_t hash = middle * 0x9E3779B97F4A7C15U + highest * 0xD1B54A32D192ED03U;
    return static_cast<std::uint16_t>((hash >> 48 & 0xFFFD) | 1);
  }

  static void note(std::uint16_t signature, Signatures& here) {
    auto* const all = reinterpret_cast<__m128i*>(here.newest.data());
    const __m128i before = _mm_load_si128(all);
    const __m128i equal = _mm_cmpeq_epi16(before, _mm_set1_epi16(static_cast<short>(signature)));
    const bool no_place = _mm_extract_epi16(before, 7) != 0;
    if (no_place || _mm_movemask_epi8(equal) != 0) {
      _mm_store_si128(all, _mm_set1_epi16(static_cast<short>(kTwins)));
    } else {
      _mm_store_si128(all, _mm_insert_epi16(_mm_slli_si128(before, 2), signature, 0));
    }
  }

  std::vector<std::uint32_t> lower_;
  std::vector<Signatures> signatures_;
};

}  // namespace raycone
