// Pseudo-random numbers that are the same everywhere: the distributions of C++'s library are not, nor are the
// logarithms of C's.
#pragma once

#include <cstdint>

namespace raycone {

class Random {
 public:
  // Each stream of a seed is a sequence of its own.
  Random(std::uint64_t seed, std::uint64_t stream);

  [[nodiscard]] std::uint64_t bits();
  // In [0, 1), a multiple of 2^-53.
  [[nodiscard]] double uniform();
  // Of mean 0 and variance 1; never farther from 0 than kLargestNormal.
  static constexpr double kLargestNormal = 12.1;  // sqrt(2 log 2^104): 2^-104 is the least square of the polar method
  [[nodiscard]] double normal();

 private:
  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace raycone
