// Verification of a run by other means: the numbers of some of its samples, which it is about to hand over, are
// compared with their definition (app/fields/verify_by_definition.h) and with what the evaluator answers when asked
// again.
#pragma once

#include <span>
#include <string>

#include "app/fields/field_evaluator.h"
#include "app/fields/sample_draw.h"
#include "app/fields/verify_by_definition.h"
#include "app/options/field_options.h"
#include "app/report/run_report.h"

namespace raycone {

// A run as it was asked for.
struct VerifiedRun {
  const FieldEvaluator& evaluator;  // that of the meshes and options
  const FieldOptions& options;
  double band_width;    // where distances are cut off, world units
  double within = 0.0;  // by how much winding numbers may differ from those at points, as those of lattices do within
                        // the tolerance (docs/method.md, "Blocks of lattices"); turns
};

// The same as verify_by_definition() of a run of `meshes`; throws VerificationError also if the evaluator answers
// differently now, as at points, or if a winding number is off by more than its error bound. Samples without a winding
// number are verified with what the evaluator answers now. Where only a rule was asked for, the difference and the
// bound of winding numbers are 0.
[[nodiscard]] Verification verify(const std::string& name, const VerifiedMeshes& meshes, const VerifiedRun& run,
                                  std::span<const DrawnSample> samples);

}  // namespace raycone
