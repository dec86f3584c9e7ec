// Verification of a run by other means: some of its samples are computed again as direct sums over all triangles, in
// 113-bit arithmetic (core/direct_sum.h), and compared with the values that the run is about to hand over.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/triangle_mesh.h"
#include "core/vec3.h"
#include "core/winding_number.h"

namespace raycone {

struct DrawnSample {
  std::uint64_t number = 0;  // in the run, from 0; those of a lattice are counted x fastest, then y, then z
  std::uint64_t rank = 0;    // pseudo-random, a one-to-one function of the number
  Vec3 point;
  double value = 0.0;  // as the run has it
};

// Draws samples from a run of unknown length: those of the lowest ranks. The choice depends on their numbers alone, not
// on the blocks and batches in which they come.
class SampleDraw {
 public:
  // At most `count` of them; 0 draws none.
  explicit SampleDraw(std::uint64_t count) : count_(count) {}

  void offer(const Lattice& lattice, const LatticeBlock& block, std::span<const double> values);
  // The points behind those offered before.
  void offer(std::span<const Vec3> points, std::span<const double> values);

  // By number.
  [[nodiscard]] std::vector<DrawnSample> samples() const;

 private:
  [[nodiscard]] bool takes(std::uint64_t rank) const;
  void keep(const DrawnSample& sample);

  std::uint64_t count_;
  std::uint64_t points_ = 0;          // offered so far
  std::vector<DrawnSample> samples_;  // a heap, the highest rank in front
};

struct Verification {
  std::uint64_t samples = 0;     // compared
  std::uint64_t on_surface = 0;  // drawn, but on the surface, where there is no direct sum
  std::uint64_t unresolved = 0;  // drawn, but so close to an edge that 113 bits tell nothing
  double largest_difference = 0.0;
  double largest_bound = 0.0;  // of what was allowed: a value's error bound and that of its direct sum
};

// A value is wrong: exit status 6. what() is one line that names the sample, both values and the bound.
class VerificationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Compares `samples` of a run of `evaluator`, which is that of `mesh`, on the threads that ThreadLimit allows: some 2.7
// us per triangle and sample. Throws VerificationError about the first one that `evaluator` answers differently now, or
// that differs from its direct sum by more than both error bounds. `name`: the file concerned.
[[nodiscard]] Verification verify(const std::string& name, const TriangleMesh& mesh,
                                  const WindingNumberEvaluator& evaluator, std::span<const DrawnSample> samples);

}  // namespace raycone
