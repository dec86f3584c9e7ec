// Flags as bits, in the order of numpy.packbits: the first one is the highest bit of the first byte.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/data/lattice.h"

namespace raycone {

// Flags one after the other; bytes are handed out as they become complete.
class FlagBits {
 public:
  // The complete bytes that `flags` add; valid until the next call.
  std::span<const std::uint8_t> append(std::span<const std::uint8_t> flags) {
    bytes_.clear();
    for (const std::uint8_t flag : flags) {
      byte_ = static_cast<std::uint8_t>(byte_ << 1 | (flag != 0 ? 1 : 0));
      if (++count_ % 8 == 0) bytes_.push_back(byte_);
    }
    return bytes_;
  }

  // The last byte, where it is not complete: zeros fill it.
  std::span<const std::uint8_t> rest() {
    bytes_.clear();
    if (count_ % 8 != 0) bytes_.push_back(static_cast<std::uint8_t>(byte_ << (8 - count_ % 8)));
    return bytes_;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint8_t byte_ = 0;
  std::uint64_t count_ = 0;
};

// Those of a lattice, x slowest and z fastest, in memory: slabs come in another order.
class LatticeBits {
 public:
  explicit LatticeBits(const Lattice& lattice)
      : lattice_(lattice), bytes_((static_cast<std::size_t>(whole(lattice).size()) + 7) / 8) {}

  void add(const LatticeBlock& block, std::span<const std::uint8_t> flags) {
    std::size_t n = 0;
    for_each_sample(block, [&](const LatticeIndex& index) {
      if (flags[n++] != 0) set(index);
    });
  }

  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  void set(const LatticeIndex& index) {
    const auto& [i, j, k] = index;
    const LatticeIndex& first = lattice_.index_min;
    const auto bit = static_cast<std::size_t>(
        ((i - first[0]) * lattice_.counts[1] + (j - first[1])) * lattice_.counts[2] + (k - first[2]));
    bytes_[bit / 8] = static_cast<std::uint8_t>(bytes_[bit / 8] | 0x80 >> bit % 8);
  }

  Lattice lattice_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace raycone
