// The samples of one layer of OpenVDB's leaves, blocks of 8^3 voxels, while they are gathered from slabs of a lattice.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/data/lattice.h"
#include "core/machine/threads.h"

namespace raycone::vdb {

inline constexpr std::int64_t kLeafLog2 = 3;
inline constexpr std::int64_t kLeafSize = 1 << kLeafLog2;
inline constexpr std::size_t kLeafVoxels = 512;

// All leaves of the lattice with one leaf coordinate along z. Leaf coordinates are sample indices divided by 8, rounded
// down. Leaves are numbered along x, then y.
template <typename Stored>
class LeafLayer {
 public:
  // `background`: what voxels beside the lattice hold.
  LeafLayer(const Lattice& lattice, Stored background) : background_(background) {
    for (std::size_t a = 0; a < 2; ++a) {
      first_[a] = lattice.index_min[a] >> kLeafLog2;
      counts_[a] = (lattice.index_max(static_cast<int>(a)) >> kLeafLog2) - first_[a] + 1;
    }
    values_.assign(size() * kLeafVoxels, background_);
    is_uniform_.assign(size(), 0);
  }

  // How many leaves there are.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(counts_[0] * counts_[1]); }

  // Indices along x and y of the first voxel of leaf n.
  [[nodiscard]] std::array<std::int64_t, 2> first_voxel(std::size_t n) const {
    const auto position = static_cast<std::int64_t>(n);
    return {(first_[0] + position % counts_[0]) * kLeafSize, (first_[1] + position / counts_[0]) * kLeafSize};
  }

  // Whether all voxels of leaf n have one value, the first of values(n); the others may not be set then.
  [[nodiscard]] bool has_one_value(std::size_t n) const {
    const Stored* const leaf = values(n);
    return is_uniform_[n] || std::all_of(leaf + 1, leaf + kLeafVoxels, [&](Stored v) { return v == *leaf; });
  }

  // The voxels of leaf n in OpenVDB's order: z fastest.
  [[nodiscard]] const Stored* values(std::size_t n) const { return &values_[n * kLeafVoxels]; }

  // Takes the planes z_begin <= z < z_end, all in this layer, from a slab of the lattice; store(number) is what is kept
  // of each sample's number.
  template <typename Number, typename Store>
  void gather(const LatticeBlock& slab, std::span<const Number> numbers, std::int64_t z_begin, std::int64_t z_end,
              const Store& store) {
    const Planes<Number> planes{slab, numbers, z_begin, z_end};
    parallel_for_each(static_cast<std::size_t>(counts_[1]), [&](std::size_t row) { gather_row(planes, row, store); });
  }

  // Starts the next layer.
  void clear() {
    parallel_for_each(size(), 16, [&](std::size_t n) {
      std::fill_n(&values_[n * kLeafVoxels], is_uniform_[n] ? 1 : kLeafVoxels, background_);
      is_uniform_[n] = 0;
    });
  }

 private:
  // Planes of a slab.
  template <typename Number>
  struct Planes {
    const LatticeBlock& slab;
    std::span<const Number> numbers;
    std::int64_t z_begin;
    std::int64_t z_end;

    // From the slab's first sample along x.
    const Number* line(std::int64_t y, std::int64_t z) const {
      const std::int64_t lines = (z - slab.first[2]) * slab.counts[1] + (y - slab.first[1]);
      return &numbers[static_cast<std::size_t>(lines * slab.counts[0])];
    }
  };

  struct Range {
    std::int64_t begin;
    std::int64_t end;
  };
  // The samples along an axis that slab and leaf block have in common.
  static Range common(const LatticeBlock& slab, std::size_t axis, std::int64_t leaf) {
    return {std::max(leaf * kLeafSize, slab.first[axis]),
            std::min((leaf + 1) * kLeafSize, slab.first[axis] + slab.counts[axis])};
  }

  // A row of leaf blocks along x. Those whose numbers are all equal, as they mostly are, are not filled.
  template <typename Number, typename Store>
  void gather_row(const Planes<Number>& planes, std::size_t row, const Store& store) {
    const Range y = common(planes.slab, 1, first_[1] + static_cast<std::int64_t>(row));
    find_uniform(planes, row, y);
    for (std::int64_t i = 0; i < counts_[0]; ++i) {
      const std::size_t n = row * static_cast<std::size_t>(counts_[0]) + static_cast<std::size_t>(i);
      const Range x = common(planes.slab, 0, first_[0] + i);
      if (is_uniform_[n]) {
        values_[n * kLeafVoxels] = store(planes.line(y.begin, planes.z_begin)[x.begin - planes.slab.first[0]]);
      } else {
        gather_leaf(planes, n, x, y, store);
      }
    }
  }

  // Line by line, in the order of memory, for all leaf blocks of a row at once.
  template <typename Number>
  void find_uniform(const Planes<Number>& planes, std::size_t row, const Range& y) {
    std::uint8_t* const uniform = &is_uniform_[row * static_cast<std::size_t>(counts_[0])];
    const bool is_whole = y.end - y.begin == kLeafSize && planes.z_end - planes.z_begin == kLeafSize;
    const std::int64_t offset = first_[0] * kLeafSize - planes.slab.first[0];  // of the first leaf in the line
    const std::int64_t begin = offset < 0 ? 1 : 0;
    const std::int64_t end = (planes.slab.counts[0] - offset) / kLeafSize;
    std::fill_n(uniform, counts_[0], std::uint8_t{0});
    if (!is_whole || begin >= end) return;
    std::fill(uniform + begin, uniform + end, std::uint8_t{1});
    const Number* const first = planes.line(y.begin, planes.z_begin);
    for (std::int64_t z = planes.z_begin; z < planes.z_end; ++z) {
      for (std::int64_t line_y = y.begin; line_y < y.end; ++line_y) {
        const Number* const line = planes.line(line_y, z);
        for (std::int64_t i = begin; i < end; ++i) {
          const std::int64_t start = offset + i * kLeafSize;
          bool differs = false;
          for (std::int64_t x = start; x < start + kLeafSize; ++x) differs |= line[x] != first[start];
          uniform[i] &= static_cast<std::uint8_t>(!differs);
        }
      }
    }
  }

  template <typename Number, typename Store>
  void gather_leaf(const Planes<Number>& planes, std::size_t n, const Range& x, const Range& y, const Store& store) {
    Stored* const leaf = &values_[n * kLeafVoxels];
    for (std::int64_t z = planes.z_begin; z < planes.z_end; ++z) {
      for (std::int64_t leaf_y = y.begin; leaf_y < y.end; ++leaf_y) {
        const Number* const line = planes.line(leaf_y, z) + (x.begin - planes.slab.first[0]);
        const auto count = static_cast<std::size_t>(x.end - x.begin);
        std::array<Stored, kLeafSize> stored;
        if constexpr (requires { store(std::span(line, count), stored.data()); }) {
          store(std::span(line, count), stored.data());
        } else {
          for (std::size_t i = 0; i < stored.size() && i < count; ++i) stored[i] = store(line[i]);
        }
        Stored* const column = leaf + (leaf_y & (kLeafSize - 1)) * kLeafSize + (z & (kLeafSize - 1)) +
                               (x.begin & (kLeafSize - 1)) * kLeafSize * kLeafSize;
        for (std::size_t i = 0; i < count; ++i) column[i * kLeafSize * kLeafSize] = stored[i];
      }
    }
  }

  Stored background_;
  std::array<std::int64_t, 2> first_{};   // leaf coordinates along x and y
  std::array<std::int64_t, 2> counts_{};  // leaves along x and y
  std::vector<Stored> values_;            // leaf by leaf
  std::vector<std::uint8_t> is_uniform_;  // per leaf: known to have one value, and no other voxel is set
};

}  // namespace raycone::vdb
