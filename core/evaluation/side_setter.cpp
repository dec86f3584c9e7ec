#include "core/evaluation/side_setter.h"

#include "core/evaluation/settler.h"

namespace raycone {

void SideSetter::wait(std::size_t index, const Vec3& scaled_query, double w) {
  indices_[waiting_.count] = index;
  values_[waiting_.count] = w;
  waiting_.add(scaled_query);
  if (waiting_.count == kTile) finish();
}

void SideSetter::finish() {
  for (const double threshold : mesh_rule_.thresholds()) {
    Settler settler(mesh_rule_.mesh(), threshold, values_);
    for (std::size_t i = 0; i < waiting_.count; ++i) {
      if (mesh_rule_.may_be_across(values_[i], threshold)) settler.add(i, waiting_.query(i));
    }
    settler.evaluate();
  }
  for (std::size_t i = 0; i < waiting_.count; ++i) sides_[indices_[i]] = holds(mesh_rule_.rule(), values_[i]) ? 1 : 0;
  waiting_.clear();
}

}  // namespace raycone
