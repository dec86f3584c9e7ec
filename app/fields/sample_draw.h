// Some samples of a run, drawn while they are evaluated, with the numbers that the run has of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/fields/fields.h"
#include "core/data/placed_lattice.h"
#include "core/data/vec3.h"

namespace raycone {

struct DrawnSample {
  std::uint64_t number = 0;  // in the run, from 0; those of a lattice are counted x fastest, then y, then z
  std::uint64_t rank = 0;    // pseudo-random, a one-to-one function of the number
  Vec3 point;
  // As the run has them; empty where a field is not wanted. To be verified, each needs its winding number.
  std::optional<double> winding{};
  std::optional<bool> inside{};
  std::optional<double> density{};
  std::optional<double> distance{};
  std::optional<double> solid{};
  std::optional<Vec3> gradient{};
  std::optional<std::int32_t> label{};
};

// The sample `n` of those that `numbers` are of.
[[nodiscard]] DrawnSample drawn_sample(std::uint64_t number, std::uint64_t rank, const Vec3& point,
                                       const SampleNumbers& numbers, std::size_t n);

// "sample 7 at (0, 0.5, 1)"
[[nodiscard]] std::string position_text(const DrawnSample& sample);

// Draws samples from a run of unknown length: those of the lowest ranks. The choice depends on their numbers alone, not
// on the blocks and batches in which they come.
class SampleDraw {
 public:
  // At most `count` of them; 0 draws none.
  explicit SampleDraw(std::uint64_t count) : count_(count) {}

  // `distances`: in place of those of `numbers`.
  void offer(const PlacedLattice& lattice, const LatticeBlock& block, const SampleNumbers& numbers,
             const SignedBlocks* distances = nullptr);
  // The points behind those offered before.
  void offer(std::span<const Vec3> points, const SampleNumbers& numbers);

  // By number.
  [[nodiscard]] std::vector<DrawnSample> samples() const;

 private:
  [[nodiscard]] bool takes(std::uint64_t rank) const;
  void keep(const DrawnSample& sample);

  std::uint64_t count_;
  std::uint64_t points_ = 0;          // offered so far
  std::vector<DrawnSample> samples_;  // a heap, the highest rank in front
};

}  // namespace raycone
