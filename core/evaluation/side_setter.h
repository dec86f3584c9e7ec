// On which side of a rule winding numbers are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/boundary/sample_tile.h"
#include "core/data/rule.h"
#include "core/evaluation/scaled_mesh.h"

namespace raycone {

// A rule, and which winding numbers of a mesh are too close to its thresholds. The mesh must outlive it. Thread-safe.
class MeshRule {
 public:
  MeshRule(const ScaledMesh& mesh, const Rule& rule)
      : mesh_(mesh),
        rule_(rule),
        thresholds_(mesh.is_closed() ? std::vector<double>() : thresholds_to_settle(rule)),
        doubt_(mesh.doubt()) {}

  [[nodiscard]] const ScaledMesh& mesh() const { return mesh_; }
  [[nodiscard]] const Rule& rule() const { return rule_; }
  [[nodiscard]] std::span<const double> thresholds() const { return thresholds_; }

  // Whether w, as the mesh's set_values() sets it, may be on the wrong side of a threshold.
  [[nodiscard]] bool may_be_across(double w, double threshold) const {
    return raycone::may_be_across(w, threshold, doubt_);
  }
  [[nodiscard]] bool is_doubtful(double w) const {
    for (const double threshold : thresholds_) {
      if (may_be_across(w, threshold)) return true;
    }
    return false;
  }

 private:
  const ScaledMesh& mesh_;
  Rule rule_;
  std::vector<double> thresholds_;
  double doubt_;
};

// Sets sides of samples, 1 where the rule holds, else 0. Values too close to a threshold wait until there are kTile of
// them, or finish() is called, and are settled together. The constructor's arguments must outlive this. Needs
// DefaultFloatingPoint; not thread-safe.
class SideSetter {
 public:
  SideSetter(const MeshRule& mesh_rule, std::span<std::uint8_t> sides) : mesh_rule_(mesh_rule), sides_(sides) {}

  // `w` as the mesh's set_values() sets it at the query.
  void set(std::size_t index, const Vec3& scaled_query, double w) {
    if (mesh_rule_.is_doubtful(w)) return wait(index, scaled_query, w);
    sides_[index] = holds(mesh_rule_.rule(), w) ? 1 : 0;
  }

  // Sets the sides of those that wait.
  void finish();

 private:
  void wait(std::size_t index, const Vec3& scaled_query, double w);

  const MeshRule& mesh_rule_;
  std::span<std::uint8_t> sides_;
  SampleTile waiting_;
  std::array<double, kTile> values_;
  std::array<std::size_t, kTile> indices_;
};

}  // namespace raycone
