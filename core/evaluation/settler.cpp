#include "core/evaluation/settler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace raycone {

// First by the direct sum: a large tolerance leaves many values to settle, and what decides the rest takes far longer.
// Values and sums are off by an eighth of a turn at most each, so that values tell the whole turns.
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
