// A field on a lattice as one array: shape (nx, ny, nz), C order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>

#include "core/data/lattice.h"
#include "io/fields/array_elements.h"
#include "io/fields/field_writer.h"
#include "io/files/output_file.h"

namespace raycone {

// "(2, 3, 4)", of vectors "(2, 3, 4, 3)"
[[nodiscard]] std::string shape_of(const Lattice& lattice, std::size_t components);

// Across which axis such arrays take their slabs. Those across the slowest axis, x, can be appended, but cut all rays,
// and each slab has to look for crossings again. Slabs across y are pieces of planes across x: long ones, as z is the
// fastest axis; only outputs that are seekable can take them.
[[nodiscard]] int array_slab_axis(const Lattice& lattice, const OutputFile& output);

class LatticeArray {
 public:
  LatticeArray(const Lattice& lattice, std::unique_ptr<ArrayElements> elements)
      : lattice_(lattice), elements_(std::move(elements)) {}

  // Calls write(offset, data, size) for the pieces of a slab: offsets are bytes from the array's beginning. Slabs in
  // order across x make pieces in order.
  template <typename Write>
  void write_slab(const LatticeBlock& block, const FieldValues& values, const Write& write);

 private:
  Lattice lattice_;
  std::unique_ptr<ArrayElements> elements_;
};

template <typename Write>
void LatticeArray::write_slab(const LatticeBlock& block, const FieldValues& values, const Write& write) {
  constexpr std::size_t kElements = std::size_t{1} << 18, kLeastPlanes = 16;
  const auto nx = static_cast<std::size_t>(block.counts[0]);
  const auto plane = static_cast<std::size_t>(block.counts[1] * block.counts[2]);
  const std::size_t planes = std::max(kElements / plane, kLeastPlanes);  // at a time
  const std::size_t size = elements_->size();
  const auto whole_plane = static_cast<std::size_t>(lattice_.counts[1] * lattice_.counts[2]);
  const auto x_before = static_cast<std::size_t>(block.first[0] - lattice_.index_min[0]);
  const auto before = static_cast<std::size_t>((block.first[1] - lattice_.index_min[1]) * lattice_.counts[2] +
                                               (block.first[2] - lattice_.index_min[2]));
  for (std::size_t begin = 0; begin < nx; begin += planes) {
    const std::size_t end = std::min(begin + planes, nx);
    const std::span<const char> bytes = elements_->planes(block, values, begin, end);
    if (plane == whole_plane) {
      write((x_before + begin) * plane * size, bytes.data(), bytes.size());
      continue;
    }
    for (std::size_t x = begin; x < end; ++x) {
      write(((x_before + x) * whole_plane + before) * size, &bytes[(x - begin) * plane * size], plane * size);
    }
  }
}

}  // namespace raycone
