// Labels: which part the rule holds for. Each part is evaluated as a mesh of its own.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/options/field_options.h"
#include "app/options/mesh_options.h"
#include "app/run/fields.h"
#include "app/run/label_volume.h"
#include "app/run/mesh_parts.h"
#include "app/run/mesh_run.h"
#include "app/run/part_evaluator.h"
#include "app/run/verify.h"
#include "core/data/lattice.h"
#include "core/mesh/mesh_defects.h"

namespace raycone {

// What the mesh of all parts together is wanted for.
enum class WholeMesh {
  kUnused,
  kShown,      // drawn
  kEvaluated,  // or drawn from: warnings and counts of orientation are about it
};

// The parts of a run, made ready one after the other. The report learns of them, their user of what is wrong with them.
class LabelledParts {
 public:
  // Reads the meshes. What is given here must outlive this.
  LabelledParts(MeshRun& run, const MeshOptions& mesh, const FieldOptions& field,
                const std::vector<WrittenFile>& written, WholeMesh whole);

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] const Box& box() const { return parts_.box(); }
  [[nodiscard]] const TriangleMesh& whole() const { return parts_.whole(); }
  [[nodiscard]] bool first_wins() const { return mesh_.parts.first_wins; }

  // The next one, from the first to the last.
  [[nodiscard]] MeshToEvaluate next();
  // Whether a part has samples inside, and whether it should have some. In order.
  void found(bool inside, bool expected);
  // What was spent on a part.
  void spent(const FieldEvaluator& evaluator);

  // When all parts have been evaluated. `samples`: of each label, from 0.
  void finish(std::span<const std::uint64_t> samples);

 private:
  void note(const MeshToEvaluate& part);
  void warn_about_file();

  MeshRun& run_;
  const MeshOptions& mesh_;
  const FieldOptions& field_;
  WholeMesh whole_;
  MeshParts parts_;
  std::size_t next_ = 0;
  std::vector<std::size_t> empty_;  // parts that should not be
  // Of the parts of the file at hand.
  std::vector<Warning> warnings_;
  MeshDefects defects_;
  std::uint64_t cut_edges_ = 0;
  // What the report is told when all has been evaluated.
  Terms terms_;
};

// Labels by definition, of some samples.
class LabelCheck {
 public:
  LabelCheck(std::vector<DrawnSample> samples, const Rule& rule, bool first_wins);
  void add(const TriangleMesh& part);  // the next one
  // Compares with what the run has. Throws VerificationError, which names `mesh`.
  [[nodiscard]] Verification compare(const std::string& mesh, std::span<const std::int32_t> labels) const;
  [[nodiscard]] const std::vector<DrawnSample>& samples() const { return samples_; }

 private:
  std::vector<DrawnSample> samples_;
  Rule rule_;
  bool first_wins_;
  std::vector<std::int32_t> labels_;
  std::vector<std::uint8_t> unresolved_;
  std::int32_t parts_ = 0;
};

// The labels of all samples of `lattice`. Reports what they took, and verifies them where that is asked for. Throws
// LimitError, VerificationError, and what reading throws.
[[nodiscard]] LabelVolume label_lattice(LabelledParts& parts, const PlacedLattice& lattice, const FieldOptions& field,
                                        MeshRun& run);

// The labels of points, batch by batch.
class PointLabels {
 public:
  // Makes all parts ready. `samples`: about how many points there are. What is given here must outlive this.
  PointLabels(LabelledParts& parts, const FieldOptions& field, double samples, MeshRun& run);

  void evaluate(std::span<const Vec3> points, std::span<std::int32_t> labels);

  // Reports what they took, and verifies them where that is asked for.
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
