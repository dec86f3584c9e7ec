#include "core/far/harmonic_error.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

namespace raycone {
namespace {

struct Entry {
  double distance, error;  // at most, from the distance on
};

// tests/core/harmonic_error_table.py 22 6; the last column of what it prints.
constexpr std::array kTable = {
    Entry{1.800000, 9.461e-04}, Entry{1.890000, 3.164e-04}, Entry{1.984500, 1.070e-04}, Entry{2.083725, 3.616e-05},
    Entry{2.187911, 1.218e-05}, Entry{2.297307, 4.075e-06}, Entry{2.412172, 1.354e-06}, Entry{2.532781, 4.461e-07},
    Entry{2.659420, 1.459e-07}, Entry{2.792391, 4.745e-08}, Entry{2.932010, 1.531e-08}, Entry{3.078611, 4.919e-09},
    Entry{3.232541, 1.569e-09}, Entry{3.394168, 4.988e-10}, Entry{3.563877, 1.581e-10}, Entry{3.742071, 4.987e-11},
    Entry{3.929174, 1.568e-11}, Entry{4.125633, 4.930e-12}, Entry{4.331915, 1.546e-12}, Entry{4.548510, 4.839e-13},
    Entry{4.775936, 1.509e-13}, Entry{5.014733, 4.705e-14},
};

}  // namespace

double dipole_error(double distance) {
  if (!(distance >= kTable.front().distance)) return std::numeric_limits<double>::infinity();
  return std::prev(std::ranges::upper_bound(kTable, distance, {}, &Entry::distance))->error;
}

}  // namespace raycone
