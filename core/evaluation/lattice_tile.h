// Samples of a lattice that are evaluated together.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/boundary/sample_tile.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// With the places of their values.
class LatticeTile {
 public:
  [[nodiscard]] bool full() const { return samples_.count == kTile; }

  void add(std::size_t index, const Vec3& scaled_query) {
    indices_[samples_.count] = index;
    samples_.add(scaled_query);
  }

  // Turns the crossings of the samples, if any, into winding numbers, and forgets them.
  void evaluate(const ScaledMesh& mesh, std::span<double> values) {
    if (samples_.count == 0) return;
    const std::span<const std::size_t> indices(indices_.data(), samples_.count);
    std::array<std::int64_t, kTile> crossings{};
    std::array<double, kTile> w;
    if (mesh.counts_crossings()) {
      std::ranges::transform(indices, crossings.begin(),
                             [&](std::size_t index) { return static_cast<std::int64_t>(values[index]); });
    }
    mesh.set_values(samples_, {crossings.data(), indices.size()}, {w.data(), indices.size()});
    for (std::size_t i = 0; i < indices.size(); ++i) values[indices[i]] = w[i];
    samples_.clear();
  }

 private:
  std::array<std::size_t, kTile> indices_;
  SampleTile samples_;
};

// Samples of rows, one row after the other. Those of one row share a ray, which saves work; where a row leaves fewer
// than fill the lanes, those of several rows are taken together.
class RowTiles {
 public:
  RowTiles(const ScaledMesh& mesh, std::span<double> values) : mesh_(mesh), values_(values) {}

  // The next `samples` samples that are added are of one row.
  void begin_row(std::size_t samples) { left_ = samples; }

  // Turns the sample's crossings into its winding number, now or in finish() at last.
  void add(std::size_t index, const Vec3& scaled_query) {
    constexpr std::size_t kAlone = 8;  // samples
    if (here_ == 0) here_ = std::min(left_, kTile), together_ = here_ >= kAlone;
    LatticeTile& tile = together_ ? along_ : across_;
    tile.add(index, scaled_query);
    --left_;
    if (--here_ == 0 && together_) tile.evaluate(mesh_, values_);
    if (tile.full()) tile.evaluate(mesh_, values_);
  }

  void finish() { across_.evaluate(mesh_, values_); }

 private:
  const ScaledMesh& mesh_;
  std::span<double> values_;
  LatticeTile along_, across_;
  std::size_t left_ = 0, here_ = 0;  // samples of the row, and of the tile, that are still to come
  bool together_ = false;
};

}  // namespace raycone
