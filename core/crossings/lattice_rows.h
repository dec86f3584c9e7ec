// The rows of a block of a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "core/crossings/row.h"
#include "core/data/box.h"
#include "core/data/lattice.h"
#include "core/data/sample_box.h"
#include "core/data/vec3.h"

namespace raycone {

// Rows (y, z) for all y of ys and z of zs, with the samples xs each; all ascending. Row number j + k * ys.size() is
// (ys[j], zs[k]).
struct LatticeRows {
  std::vector<double> xs, ys, zs;
  Vec3 samples_per_unit;  // as in Row, per axis

  [[nodiscard]] std::size_t size() const { return ys.size() * zs.size(); }
  [[nodiscard]] Row row(std::size_t number) const {
    return {ys[number % ys.size()], zs[number / ys.size()], xs, samples_per_unit.x};
  }
  [[nodiscard]] const std::vector<double>& along(std::size_t axis) const {
    return axis == 0 ? xs : axis == 1 ? ys : zs;
  }
  [[nodiscard]] std::array<std::size_t, 3> counts() const { return {xs.size(), ys.size(), zs.size()}; }
  [[nodiscard]] Vec3 query(const std::array<std::size_t, 3>& sample) const {
    return {xs[sample[0]], ys[sample[1]], zs[sample[2]]};
  }
  // What the samples, at least one, span.
  [[nodiscard]] Box box_of(const SampleBox& samples) const {
    return {query(samples.begin), query({samples.end[0] - 1, samples.end[1] - 1, samples.end[2] - 1})};
  }
};

// Those of a block that has samples, each coordinate by to_scale(), which keeps their order.
[[nodiscard]] LatticeRows rows_in_scale(const Lattice& lattice, const LatticeBlock& block,
                                        const std::function<double(double)>& to_scale);

}  // namespace raycone
