#include "app/verify.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>

#include "app/fields.h"
#include "core/direct_sum.h"
#include "core/threads.h"

namespace raycone {
namespace {

// The output function of SplitMix64 (Steele, Lea, Flood 2014), which is one-to-one.
std::uint64_t rank_of(std::uint64_t number) {
  std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

bool by_rank(const DrawnSample& a, const DrawnSample& b) { return a.rank < b.rank; }

// Shortest text that reads back as the same double.
std::string text(double number) {
  std::array<char, 32> characters;
  return {characters.data(), std::to_chars(characters.data(), characters.data() + characters.size(), number).ptr};
}

std::string description_of(const DrawnSample& sample) {
  return "sample " + std::to_string(sample.number) + " at (" + text(sample.point.x) + ", " + text(sample.point.y) +
         ", " + text(sample.point.z) + ") has the value " + text(sample.value);
}

// A sample's direct sum beside its value.
struct Comparison {
  Quad direct = 0;
  Quad difference = 0;
  Quad bound = 0;  // of the difference, where both are right
  bool resolved = false;
};

Comparison compare(const TriangleMesh& mesh, const DrawnSample& sample, double error_bound) {
  const Vec3& p = sample.point;
  const QuadWithin direct = direct_winding_number(mesh, {p.x, p.y, p.z});
  const Quad difference = sample.value - direct.value;
  // An error of 0.5 is that of a triangle whose term had no digit left.
  return {direct.value, difference < 0 ? -difference : difference, error_bound + direct.error, direct.error < 0.5};
}

void check_repeated(const std::string& name, std::span<const DrawnSample> samples, std::span<const double> repeated) {
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (std::bit_cast<std::uint64_t>(samples[n].value) == std::bit_cast<std::uint64_t>(repeated[n])) continue;
    throw VerificationError(name + ": " + description_of(samples[n]) + ", but evaluated again " + text(repeated[n]) +
                            ", expected the same bits");
  }
}

void check(const std::string& name, const DrawnSample& sample, const Comparison& comparison) {
  if (comparison.difference <= comparison.bound) return;
  throw VerificationError(name + ": " + description_of(sample) + ", but the direct sum is " +
                          text(static_cast<double>(comparison.direct)) + ", " +
                          text(static_cast<double>(comparison.difference)) + " away, beyond the error bound " +
                          text(static_cast<double>(comparison.bound)));
}

}  // namespace

bool SampleDraw::takes(std::uint64_t rank) const {
  return samples_.size() < count_ || (count_ > 0 && rank < samples_.front().rank);
}

void SampleDraw::keep(const DrawnSample& sample) {
  if (samples_.size() == count_) {
    std::ranges::pop_heap(samples_, by_rank);
    samples_.pop_back();
  }
  samples_.push_back(sample);
  std::ranges::push_heap(samples_, by_rank);
}

void SampleDraw::offer(const Lattice& lattice, const LatticeBlock& block, std::span<const double> values) {
  if (count_ == 0) return;
  const auto place = [&](std::size_t axis, std::int64_t index) {
    return static_cast<std::uint64_t>(index - lattice.index_min[axis]);
  };
  const auto nx = static_cast<std::uint64_t>(lattice.counts[0]), ny = static_cast<std::uint64_t>(lattice.counts[1]);
  const double* value = values.data();
  for (std::int64_t k = block.first[2]; k < block.first[2] + block.counts[2]; ++k) {
    for (std::int64_t j = block.first[1]; j < block.first[1] + block.counts[1]; ++j) {
      for (std::int64_t i = block.first[0]; i < block.first[0] + block.counts[0]; ++i, ++value) {
        const std::uint64_t number = (place(2, k) * ny + place(1, j)) * nx + place(0, i);
        const std::uint64_t rank = rank_of(number);
        if (!takes(rank)) continue;
        keep({number, rank, {lattice.coordinate(0, i), lattice.coordinate(1, j), lattice.coordinate(2, k)}, *value});
      }
    }
  }
}

void SampleDraw::offer(std::span<const Vec3> points, std::span<const double> values) {
  for (std::size_t n = 0; n < points.size(); ++n, ++points_) {
    const std::uint64_t rank = rank_of(points_);
    if (takes(rank)) keep({points_, rank, points[n], values[n]});
  }
}

std::vector<DrawnSample> SampleDraw::samples() const {
  std::vector<DrawnSample> result = samples_;
  std::ranges::sort(result, {}, &DrawnSample::number);
  return result;
}

Verification verify(const std::string& name, const TriangleMesh& mesh, const WindingNumberEvaluator& evaluator,
                    std::span<const DrawnSample> samples) {
  std::vector<Vec3> points;
  for (const DrawnSample& sample : samples) points.push_back(sample.point);
  FieldOptions with_diagnostics;
  with_diagnostics.diagnostics = true;
  FieldSamples repeated(with_diagnostics);
  repeated.resize(points.size());
  const Diagnostics& diagnostics = *repeated.diagnostics();
  evaluator.evaluate(points, repeated.winding_numbers(), nullptr, &diagnostics);
  check_repeated(name, samples, repeated.winding_numbers());

  std::vector<Comparison> comparisons(samples.size());
  parallel_for(samples.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (!diagnostics.on_surface[n]) comparisons[n] = compare(mesh, samples[n], diagnostics.error_bound[n]);
    }
  });

  Verification verification;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (diagnostics.on_surface[n]) {
      ++verification.on_surface;
    } else if (!comparisons[n].resolved) {
      ++verification.unresolved;
    } else {
      check(name, samples[n], comparisons[n]);
      ++verification.samples;
      const auto larger = [](double a, Quad b) { return std::max(a, static_cast<double>(b)); };
      verification.largest_difference = larger(verification.largest_difference, comparisons[n].difference);
      verification.largest_bound = larger(verification.largest_bound, comparisons[n].bound);
    }
  }
  return verification;
}

}  // namespace raycone
