// A batch at work, from its plan to its results.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "app/batch/batch_progress.h"
#include "app/batch/batch_record.h"
#include "app/batch/batch_summary.h"
#include "app/batch/job_result.h"
#include "app/batch/plan.h"
#include "app/batch/prune.h"
#include "app/batch/results_files.h"
#include "app/batch/supervisor.h"
#include "app/options/batch_command.h"

namespace raycone {

// What there is to do.
struct BatchWork {
  std::vector<std::string> searched;  // directories
  Plan plan;
  GoneMeshes gone;  // rows to be removed
};

// Is run once; outcome() is known after that. For one thread.
class BatchRun {
 public:
  // `command` and `options` must outlive this.
  BatchRun(const BatchCommand& command, const PlanOptions& options, BatchWork work);

  // Does the work and keeps the results, in a directory that is there. Returns the signal that interrupted it, or 0.
  // Throws InputError, OutputError, LimitError, and what BatchMarker throws.
  int run(const SupervisorOptions& limits);

  [[nodiscard]] const BatchOutcome& outcome() const { return outcome_; }

 private:
  void remove_debris() const;
  void remove_gone();
  void forget_rows();
  [[nodiscard]] bool was_searched(const BatchRecord& record) const;
  [[nodiscard]] std::string path_of_output(const BatchMesh& mesh) const;
  [[nodiscard]] std::set<std::string> directories_of(const BatchMesh& mesh) const;
  [[nodiscard]] std::vector<SupervisedJob> make_jobs() const;
  [[nodiscard]] bool take(std::size_t job, JobResult result, double part);
  [[nodiscard]] BatchRecord record_of(const BatchMesh& mesh, JobResult result) const;
  void keep_results();

  const BatchCommand& command_;
  const PlanOptions& options_;
  BatchWork work_;
  ResultsFiles results_;
  BatchProgress progress_;
  Starts starts_;  // of all that is to be done
  BatchOutcome outcome_;
};

}  // namespace raycone
