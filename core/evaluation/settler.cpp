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
  std::array<Boundary::ToSettle, kTile> doubtful;
  std::size_t doubts = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double& value = values_[indices_[i]];
    direct[i] += std::nearbyint(value - direct[i]);
    if (!(std::abs(direct[i] - critical_) > mesh_.doubt_of_direct_values())) {
      doubtful[doubts++] = {i, critical_};
    } else if (direct[i] > critical_) {
      value = std::max(value, std::nextafter(critical_, kInfinity));
    } else {
      value = std::min(value, std::nextafter(critical_, -kInfinity));
    }
  }
  mesh_.boundary().settle(samples_, {doubtful.data(), doubts}, direct);
  for (std::size_t n = 0; n < doubts; ++n) values_[indices_[doubtful[n].sample]] = direct[doubtful[n].sample];
  samples_.clear();
}

}  // namespace raycone
