// Labels: which part the rule holds for. Each part is evaluated as a mesh of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/fields/fields.h"
#include "app/fields/label_volume.h"
#include "app/fields/part_evaluator.h"
#include "app/fields/sample_draw.h"
#include "app/options/field_options.h"
#include "app/run/labelled_parts.h"
#include "app/run/mesh_run.h"
#include "core/data/placed_lattice.h"
#include "core/data/triangle_mesh.h"

namespace raycone {

// The labels of all samples of `lattice`. Tells the report what they took, and verifies them where asked for. Throws
// VerificationError, and what reading parts throws. Precondition: there is memory for a LabelVolume.
[[nodiscard]] LabelVolume label_lattice(LabelledParts& parts, const PlacedLattice& lattice, const FieldOptions& field,
                                        MeshRun& run);

// The labels of points, batch by batch.
class PointLabels {
 public:
  // Makes all parts ready, and keeps them. `samples`: how many points there will be, about. All that is given here must
  // outlive this. Throws what reading parts throws.
  PointLabels(LabelledParts& parts, const FieldOptions& field, double samples, MeshRun& run);

  // Sets the label of each point; 0 where it is in no part. Precondition: as many labels as points.
  void evaluate(std::span<const Vec3> points, std::span<std::int32_t> labels);

  // Call it last. Tells the report what labels took, and verifies them where asked for. Throws VerificationError.
  void finish();

 private:
  LabelledParts& parts_;
  const FieldOptions& field_;
  MeshRun& run_;
  std::vector<std::unique_ptr<PartEvaluator>> evaluators_;
  std::vector<TriangleMesh> meshes_;  // to verify
  FieldSamples inside_;               // of one part at some points
  std::vector<std::uint64_t> counts_;
  SampleDraw draw_;
};

}  // namespace raycone
