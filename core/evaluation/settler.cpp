#include "core/evaluation/settler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace raycone {

// First by the direct sum, which is a hundred times as fast as what decides the rest: a large tolerance leaves many
// values to settle. Whole turns are those of the values, which are off by an eighth at most, as the sum is.
void Settler::evaluate() {
  const std::size_t count = samples_.count;
  if (count == 0) return;
  constexpr std::array<std::int64_t, kTile> kNoCrossings{};
  std::array<double, kTile> direct;
  mesh_.set_direct_values(samples_, {kNoCrossings.data(), count}, {direct.data(), count}, ScaledMesh::Settling::kLeft);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    double& value = values_[indices_[i]];
    const double w = direct[i] + std::nearbyint(value - direct[i]);
    if (!(std::abs(w - critical_) > mesh_.doubt_of_direct_values())) {
      value = mesh_.boundary().settle(samples_.query(i), w, critical_);
    } else if (w > critical_) {
      value = std::max(value, std::nextafter(critical_, kInfinity));
    } else {
      value = std::min(value, std::nextafter(critical_, -kInfinity));
    }
  }
  samples_.clear();
}

}  // namespace raycone
