#include "core/far/harmonic_error.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace raycone {
namespace {

struct Entry {
  double distance, error;  // at most, from the distance on
};

// tests/core/harmonic_error_table.py 22 6; the last column of what it prints.
constexpr std::array kTable = {
    Entry{1.500000, 1.738e-02}, Entry{1.515000, 1.398e-02}, Entry{1.530150, 1.124e-02}, Entry{1.545452, 9.048e-03},
    Entry{1.560906, 7.287e-03}, Entry{1.576515, 5.874e-03}, Entry{1.592280, 4.737e-03}, Entry{1.608203, 3.818e-03},
    Entry{1.624285, 3.082e-03}, Entry{1.640528, 2.486e-03}, Entry{1.656933, 2.005e-03}, Entry{1.673503, 1.619e-03},
    Entry{1.690238, 1.307e-03}, Entry{1.707140, 1.053e-03}, Entry{1.724211, 8.492e-04}, Entry{1.741453, 6.854e-04},
    Entry{1.758868, 5.525e-04}, Entry{1.776457, 4.452e-04}, Entry{1.794221, 3.590e-04}, Entry{1.812163, 2.894e-04},
    Entry{1.830285, 2.332e-04}, Entry{1.848588, 1.877e-04}, Entry{1.867074, 1.511e-04}, Entry{1.885745, 1.217e-04},
    Entry{1.904602, 9.787e-05}, Entry{1.923648, 7.875e-05}, Entry{1.942884, 6.327e-05}, Entry{1.962313, 5.083e-05},
    Entry{1.981936, 4.083e-05}, Entry{2.001756, 3.279e-05}, Entry{2.021773, 2.633e-05}, Entry{2.041991, 2.114e-05},
    Entry{2.062411, 1.695e-05}, Entry{2.083035, 1.358e-05}, Entry{2.103865, 1.089e-05}, Entry{2.124904, 8.712e-06},
    Entry{2.146153, 6.976e-06}, Entry{2.167615, 5.585e-06}, Entry{2.189291, 4.469e-06}, Entry{2.211184, 3.576e-06},
    Entry{2.233296, 2.860e-06}, Entry{2.255629, 2.286e-06}, Entry{2.278185, 1.827e-06}, Entry{2.300967, 1.460e-06},
    Entry{2.323976, 1.166e-06}, Entry{2.347216, 9.296e-07}, Entry{2.370688, 7.417e-07}, Entry{2.394395, 5.915e-07},
    Entry{2.418339, 4.715e-07}, Entry{2.442523, 3.757e-07}, Entry{2.466948, 2.993e-07}, Entry{2.491617, 2.383e-07},
    Entry{2.516533, 1.897e-07}, Entry{2.541699, 1.509e-07}, Entry{2.567116, 1.200e-07}, Entry{2.592787, 9.536e-08},
    Entry{2.618715, 7.578e-08}, Entry{2.644902, 6.020e-08}, Entry{2.671351, 4.780e-08}, Entry{2.698064, 3.795e-08},
    Entry{2.725045, 3.012e-08}, Entry{2.752295, 2.389e-08}, Entry{2.779818, 1.894e-08}, Entry{2.807617, 1.502e-08},
    Entry{2.835693, 1.190e-08}, Entry{2.864050, 9.416e-09}, Entry{2.892690, 7.455e-09}, Entry{2.921617, 5.901e-09},
    Entry{2.950833, 4.670e-09}, Entry{2.980342, 3.694e-09}, Entry{3.010145, 2.922e-09}, Entry{3.040247, 2.311e-09},
    Entry{3.070649, 1.826e-09}, Entry{3.101355, 1.443e-09}, Entry{3.132369, 1.140e-09}, Entry{3.163693, 8.993e-10},
    Entry{3.195330, 7.099e-10}, Entry{3.227283, 5.603e-10}, Entry{3.259556, 4.421e-10}, Entry{3.292151, 3.488e-10},
    Entry{3.325073, 2.751e-10}, Entry{3.358324, 2.170e-10}, Entry{3.391907, 1.710e-10}, Entry{3.425826, 1.348e-10},
    Entry{3.460084, 1.062e-10}, Entry{3.494685, 8.357e-11}, Entry{3.529632, 6.583e-11}, Entry{3.564928, 5.184e-11},
    Entry{3.600577, 4.081e-11}, Entry{3.636583, 3.212e-11}, Entry{3.672949, 2.527e-11}, Entry{3.709679, 1.988e-11},
    Entry{3.746775, 1.564e-11}, Entry{3.784243, 1.230e-11}, Entry{3.822085, 9.671e-12}, Entry{3.860306, 7.603e-12},
    Entry{3.898909, 5.975e-12}, Entry{3.937898, 4.695e-12}, Entry{3.977277, 3.689e-12}, Entry{4.017050, 2.899e-12},
    Entry{4.057221, 2.278e-12}, Entry{4.097793, 1.790e-12}, Entry{4.138771, 1.405e-12}, Entry{4.180159, 1.103e-12},
    Entry{4.221960, 8.655e-13}, Entry{4.264180, 6.795e-13}, Entry{4.306822, 5.334e-13}, Entry{4.349890, 4.187e-13},
    Entry{4.393389, 3.286e-13}, Entry{4.437323, 2.577e-13}, Entry{4.481696, 2.022e-13}, Entry{4.526513, 1.586e-13},
    Entry{4.571778, 1.244e-13}, Entry{4.617496, 9.756e-14}, Entry{4.663671, 7.651e-14}, Entry{4.710307, 5.996e-14},
    Entry{4.757410, 4.702e-14}, Entry{4.804985, 3.687e-14}, Entry{4.853034, 2.890e-14}, Entry{4.901565, 2.265e-14},
    Entry{4.950580, 1.777e-14}, Entry{5.000086, 1.392e-14}, Entry{5.050087, 1.092e-14}, Entry{5.100588, 8.546e-15},
    Entry{5.200000, 5.326e-15}, Entry{5.460000, 1.611e-15}, Entry{5.733000, 4.873e-16}, Entry{6.019650, 1.567e-16},
    Entry{6.320633, 5.388e-17},
};

// Of steps from the table's first distance on: the last entry that is not beyond the step's start. The table's entries
// are farther from each other than a step is long.
constexpr double kStepsPerUnit = 128.0;
constexpr auto kLast = [] {
  constexpr double kReach = kTable.back().distance - kTable.front().distance;
  std::array<std::uint8_t, static_cast<std::size_t>(kReach * kStepsPerUnit) + 2> last{};
  for (std::size_t step = 0, n = 0; step < last.size(); ++step) {
    const double start = kTable.front().distance + static_cast<double>(step) / kStepsPerUnit;
    while (n + 1 < kTable.size() && kTable[n + 1].distance <= start) ++n;
    last[step] = static_cast<std::uint8_t>(n);
  }
  return last;
}();
static_assert(kTable.size() <= 256 && kTable[1].distance - kTable[0].distance > 1 / kStepsPerUnit);

}  // namespace

// The step is found without rounding: the difference has no more bits than the distance.
double dipole_error(double distance) {
  if (!(distance >= kTable.front().distance)) return std::numeric_limits<double>::infinity();
  const double step = (distance - kTable.front().distance) * kStepsPerUnit;
  const std::size_t n = kLast[static_cast<std::size_t>(std::min(step, static_cast<double>(kLast.size() - 1)))];
  const bool is_beyond_next = n + 1 < kTable.size() && kTable[n + 1].distance <= distance;
  return kTable[n + (is_beyond_next ? 1 : 0)].error;
}

}  // namespace raycone
