// A small picture of a lattice: the middle layer across its shortest side.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/data/lattice.h"

namespace raycone {

// Put together slab by slab; costs next to nothing beside the evaluation.
class Thumbnail {
 public:
  // The winding numbers of a block of the lattice, x fastest, then y, then z. All blocks are of one lattice.
  void add(const Lattice& lattice, const LatticeBlock& block, std::span<const double> values);

  // A BMP of sixteen colours, at most 64 pixels wide and high; empty before anything was added.
  [[nodiscard]] std::string bmp() const;

 private:
  void choose_layer(const Lattice& lattice);

  // Axes to the right, upwards and across.
  std::size_t right_ = 0;
  std::size_t up_ = 1;
  std::size_t across_ = 2;
  std::int64_t layer_ = 0;  // its index along `across_`
  std::int64_t width_ = 0;
  std::int64_t height_ = 0;
  std::vector<std::uint8_t> colours_;  // of the pixels, row by row from below
};

}  // namespace raycone
