// Samples of a lattice that are evaluated together.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// With the places of their values. set(index, scaled query, w) takes each winding number.
template <class Set>
class LatticeTile {
 public:
  enum class Sum { kCheapest, kDirect, kUnsettled };  // the last one: the cheapest, not settled at half-integers
  LatticeTile(const ScaledMesh& mesh, Set set, Sum sum = Sum::kCheapest)
      : mesh_(mesh), set_(std::move(set)), sum_(sum) {}

  // `crossings`: of the sample's ray; any where the mesh does not count them. Evaluates all where the tile is full.
  void add(std::size_t index, const Vec3& scaled_query, std::int64_t crossings) {
    knows_caps_ = false;
    add(index, scaled_query, crossings, 0);
  }

  // With the crossings of mesh.caps(); of all samples, or of none.
  void add(std::size_t index, const Vec3& scaled_query, std::int64_t crossings, std::int64_t cap_crossings) {
    indices_[samples_.count] = index;
    crossings_[samples_.count] = crossings;
    of_closed_[samples_.count] = crossings - cap_crossings;
    samples_.add(scaled_query);
    if (samples_.count == kTile) evaluate();
  }

  // Evaluates the samples, and forgets them.
  void evaluate() {
    const std::size_t count = samples_.count;
    if (count == 0) return;
    std::array<double, kTile> w;
    if (sum_ == Sum::kDirect) {
      mesh_.set_direct_values(samples_, {crossings_.data(), count}, {w.data(), count});
    } else {
      mesh_.set_values(samples_, {crossings_.data(), count}, {w.data(), count},
                       sum_ == Sum::kUnsettled ? ScaledMesh::Settling::kLeft : ScaledMesh::Settling::kDone,
                       {of_closed_.data(), knows_caps_ ? count : 0});
    }
    for (std::size_t i = 0; i < count; ++i) set_(indices_[i], samples_.query(i), w[i]);
    samples_.clear();
  }

 private:
  const ScaledMesh& mesh_;
  Set set_;
  Sum sum_;
  std::array<std::size_t, kTile> indices_;
  std::array<std::int64_t, kTile> crossings_, of_closed_;
  bool knows_caps_ = true;
  SampleTile samples_;
};

// Samples of rows, one row after the other. Those of one row share a ray, which saves work; where a row leaves fewer
// than fill the lanes, those of several rows are taken together.
template <class Set>
class RowTiles {
 public:
  RowTiles(const ScaledMesh& mesh, const Set& set,
           typename LatticeTile<Set>::Sum sum = LatticeTile<Set>::Sum::kCheapest)
      : along_(mesh, set, sum), across_(mesh, set, sum) {}

  // The next `samples` samples that are added are of one row.
  void begin_row(std::size_t samples) { left_ = samples; }

  // Evaluates it, now or in finish() at last.
  void add(std::size_t index, const Vec3& scaled_query, std::int64_t crossings) {
    constexpr std::size_t kAlone = 8;  // samples
    if (here_ == 0) {
      here_ = std::min(left_, kTile);
      together_ = here_ >= kAlone;
    }
    (together_ ? along_ : across_).add(index, scaled_query, crossings);
    --left_;
    if (--here_ == 0 && together_) along_.evaluate();
  }

  void finish() { across_.evaluate(); }

 private:
  LatticeTile<Set> along_, across_;
  std::size_t left_ = 0, here_ = 0;  // samples of the row, and of the tile, that are still to come
  bool together_ = false;
};

// Sets the value with the index.
struct SetValue {
  std::span<double> values;

  void operator()(std::size_t index, const Vec3&, double w) const { values[index] = w; }
};

}  // namespace raycone
