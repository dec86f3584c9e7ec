// Verification of labels (app/fields/verify_by_definition.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/fields/sample_draw.h"
#include "app/options/mesh_options.h"
#include "app/report/run_report.h"
#include "core/data/rule.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// Labels by definition, of some samples.
class LabelCheck {
 public:
  LabelCheck(std::vector<DrawnSample> samples, const Rule& rule, PartPriority priority);
  void add(const TriangleMesh& part);  // the next one
  // Compares with what the run has. Throws VerificationError, which names `mesh`.
  [[nodiscard]] Verification compare(const std::string& mesh, std::span<const std::int32_t> labels) const;
  [[nodiscard]] const std::vector<DrawnSample>& samples() const { return samples_; }

 private:
  std::vector<DrawnSample> samples_;
  Rule rule_;
  PartPriority priority_;
  std::vector<std::int32_t> labels_;
  std::vector<std::uint8_t> unresolved_;
  std::int32_t parts_ = 0;
};

}  // namespace raycone
