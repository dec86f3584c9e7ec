// On which side of a rule a winding number is.
#pragma once

#include <cstdint>
#include <vector>

#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// Settles values that are too close to a threshold. Thread-safe.
class SideOf {
 public:
  SideOf(const ScaledMesh& mesh, const Rule& rule)
      : mesh_(mesh),
        rule_(rule),
        thresholds_(mesh.is_closed() ? std::vector<double>() : thresholds_to_settle(rule)),
        doubt_(mesh.doubt()) {}

  [[nodiscard]] const Rule& rule() const { return rule_; }

  // 1 where the rule holds, else 0; `w` as the mesh's set_values() sets it at the query.
  [[nodiscard]] std::uint8_t operator()(const Vec3& scaled_query, double w) const {
    for (const double threshold : thresholds_) {
      if (may_be_across(w, threshold, doubt_)) w = mesh_.boundary().settle(scaled_query, w, threshold);
    }
    return holds(rule_, w) ? 1 : 0;
  }

 private:
  const ScaledMesh& mesh_;
  Rule rule_;
  std::vector<double> thresholds_;
  double doubt_;
};

}  // namespace raycone
