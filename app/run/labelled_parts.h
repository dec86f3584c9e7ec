// The parts that labels tell apart, as meshes of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/fields/part_evaluator.h"
#include "app/input/mesh_parts.h"
#include "app/options/field_options.h"
#include "app/options/mesh_options.h"
#include "app/run/mesh_run.h"
#include "core/orientation/mesh_defects.h"
#include "core/orientation/orient.h"

namespace raycone {

// The parts of a run, made ready one after the other. Tells the report of them, and warns the user of their flaws.
class LabelledParts {
 public:
  // Reads the meshes. All that is given here but `written` must outlive this. Throws as MeshParts does, and as
  // MeshRun::check_files_read().
  LabelledParts(MeshRun& run, const MeshOptions& mesh, const FieldOptions& field,
                const std::vector<WrittenFile>& written, WholeMesh whole);

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] const Box& box() const { return parts_.box(); }
  [[nodiscard]] const TriangleMesh& whole() const { return parts_.whole(); }
  [[nodiscard]] PartPriority priority() const { return mesh_.parts.priority; }

  // The next part, from the first to the last; call it size() times at most.
  [[nodiscard]] MeshToEvaluate next();
  // Call it, before next(), for a part that has no samples inside, though it should have some.
  void note_empty();
  // Adds to the report what evaluating a part took.
  void spent(const FieldEvaluator& evaluator);
  // Adds what was counted at some samples of a part.
  void count(const Tally& tally) { tally_ += tally; }

  // Call it when all parts have been evaluated. `samples`: how many have each label, from 0.
  void finish(std::span<const std::uint64_t> samples);

 private:
  void note(const MeshToEvaluate& part);
  void warn_about_file();
  void warn_of_empty_parts();

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
  OrientationCounts turned_;
  // What the report is told when all has been evaluated.
  Terms terms_;
  Tally tally_;  // where nothing is asked about all of them together
};

}  // namespace raycone
