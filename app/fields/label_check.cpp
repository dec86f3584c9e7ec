#include "app/fields/label_check.h"

#include <cstddef>
#include <optional>
#include <utility>

#include "app/fields/verify_by_definition.h"
#include "core/machine/threads.h"

namespace raycone {

LabelCheck::LabelCheck(std::vector<DrawnSample> samples, const Rule& rule, PartPriority priority)
    : samples_(std::move(samples)),
      rule_(rule),
      priority_(priority),
      labels_(samples_.size()),
      unresolved_(samples_.size()) {}

void LabelCheck::add(const TriangleMesh& part) {
  ++parts_;
  parallel_for_each(samples_.size(), [&](std::size_t n) {
    const std::optional<bool> inside = inside_by_definition(part, samples_[n].point, rule_);
    if (!inside) unresolved_[n] = 1;
    const bool is_taken = labels_[n] != 0 && priority_ == PartPriority::kFirst;
    if (inside.value_or(false) && !is_taken) labels_[n] = parts_;
  });
}

Verification LabelCheck::compare(const std::string& mesh, std::span<const std::int32_t> labels) const {
  Verification verification;
  for (std::size_t n = 0; n < samples_.size(); ++n) {
    if (unresolved_[n] != 0) {
      ++verification.unresolved;
      continue;
    }
    ++verification.samples;
    if (labels[n] == labels_[n]) continue;
    throw VerificationError(mesh + ": " + position_text(samples_[n]) + " has the label " + std::to_string(labels[n]) +
                            ", expected " + std::to_string(labels_[n]) + " by definition and " + name_of(rule_));
  }
  return verification;
}

}  // namespace raycone
