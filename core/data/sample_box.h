// Samples of a lattice or of a block of it, by their numbers along each axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace raycone {

// Samples [begin, end) of each axis.
struct SampleBox {
  std::array<std::size_t, 3> begin, end;

  [[nodiscard]] std::size_t side(std::size_t axis) const { return end[axis] - begin[axis]; }
  [[nodiscard]] std::size_t size() const { return side(0) * side(1) * side(2); }
};

// The boxes of at most `most` samples along each axis that so many samples are made of; x fastest.
class SampleBoxes {
 public:
  SampleBoxes(const std::array<std::size_t, 3>& samples, std::size_t most) : samples_(samples), most_(most) {
    for (std::size_t axis = 0; axis < 3; ++axis) counts_[axis] = (samples[axis] + most - 1) / most;
  }

  [[nodiscard]] const std::array<std::size_t, 3>& counts() const { return counts_; }  // of boxes, per axis
  [[nodiscard]] std::size_t size() const { return counts_[0] * counts_[1] * counts_[2]; }
  [[nodiscard]] SampleBox operator[](std::size_t n) const {
    const std::array<std::size_t, 3> number{n % counts_[0], n / counts_[0] % counts_[1], n / counts_[0] / counts_[1]};
    SampleBox box{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.begin[axis] = number[axis] * most_;
      box.end[axis] = std::min(box.begin[axis] + most_, samples_[axis]);
    }
    return box;
  }

 private:
  std::array<std::size_t, 3> samples_, counts_{};
  std::size_t most_;
};

}  // namespace raycone
