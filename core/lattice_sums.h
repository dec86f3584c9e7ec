// What triangles say about the samples of a lattice, summed up while they say it: the memory that takes does not grow
// with the number of crossings, which soups and sheets have by the thousand per row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/crossings.h"
#include "core/diagnostics.h"

namespace raycone {

// Rows of `samples` samples each; sample i of row r is number r * samples + i of all spans.
class LatticeSums {
 public:
  // `crossings` receives n of each sample, an integer; empty where nobody asks for it. `diagnostics`, where given, its
  // crossings (which need `crossings`), degenerate and on_surface. Both must outlive this.
  LatticeSums(std::size_t rows, std::size_t samples, std::span<double> crossings, const Diagnostics* diagnostics);

  // Bytes per sample that this takes beside the caller's spans.
  static constexpr std::size_t kBytesPerSample = sizeof(std::uint8_t);

  // Adds what a triangle says about a row. Thread-safe.
  void add(std::size_t row, const TriangleCrossing& crossing);

  // Completes a row when all has been added: until then the spans hold differences. Returns how many of its samples lie
  // on the surface. Once per row; different rows at the same time.
  std::uint64_t finish(std::size_t row);

 private:
  std::size_t samples_;
  std::span<double> crossings_;
  const Diagnostics* diagnostics_;
  std::vector<std::uint8_t> own_on_surface_;  // where there are no diagnostics
  std::span<std::uint8_t> on_surface_;
};

}  // namespace raycone
