#include "app/batch/batch_run.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/batch/batch_marker.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "app/process/stopwatch.h"
#include "app/text/plain_text.h"
#include "io/files/file_identity.h"
#include "io/files/file_time.h"
#include "io/files/temporary_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

// Now, or where clocks differ or are set back at least later than `earlier`: nanoseconds since 1970.
std::int64_t time_after(std::int64_t earlier) { return std::max(nanoseconds_now(), earlier + 1); }

}  // namespace

BatchRun::BatchRun(const BatchCommand& command, const PlanOptions& options, BatchWork work)
    : command_(command),
      options_(options),
      work_(std::move(work)),
      results_(command.directory, command.shard),
      progress_(progress_style(command.run.progress_mode()), work_.plan.todo.size()) {}

int BatchRun::run(const SupervisorOptions& limits) {
  const HeldSignals signals;
  BatchMarker marker(command_.directory, options_.version + '\n' + options_.options);
  remove_debris();
  remove_gone();
  forget_rows();
  const std::vector<SupervisedJob> jobs = make_jobs();
  const int signal = timed(outcome_.seconds, [&] {
    return supervise(
        jobs, limits, signals,
        [this](std::size_t job, JobResult result, double part) { return take(job, std::move(result), part); },
        [this, &marker] {
          progress_.show();
          marker.renew();
        });
  });
  progress_.erase();
  keep_results();
  return signal;
}

void BatchRun::remove_gone() {
  if (work_.gone.empty()) return;
  std::set<std::string> names;
  for (const auto& [name, path] : work_.gone) names.insert(name);
  if (command_.shard) {
    results_.remove(names);
  } else {
    remove_from_all_results(command_.directory, names);
  }
  outcome_.pruned = names.size();
}

// What killed runs left where outputs are, or will be.
void BatchRun::remove_debris() const {
  std::set<std::string> directories{command_.directory};
  for (const auto& [name, record] : read_all_results(command_.directory)) {
    if (record.row.output.empty()) continue;
    directories.insert(directory_of(follow_links(command_.directory + '/' + record.row.output)));
  }
  for (const PlannedMesh& planned : work_.plan.todo) directories.merge(directories_of(planned.mesh));
  std::ranges::for_each(directories, remove_abandoned_files);
}

// Of meshes that are about to be evaluated again.
void BatchRun::forget_rows() {
  for (const PlannedMesh& planned : work_.plan.todo) starts_.emplace(planned.mesh.name, time_after(planned.earlier));
  for (const auto& [name, record] : results_.read()) {
    const bool is_of_directory = name.ends_with('/') && !work_.plan.kept.contains(name);
    if (is_of_directory && was_searched(record)) starts_.emplace(name, time_after(finished(record)));
  }
  results_.forget(starts_);
}

// Whether a directory that could not be read then is one of ours; who else it is of will look there again.
bool BatchRun::was_searched(const BatchRecord& record) const {
  return !record.origin || std::ranges::any_of(work_.searched, [&record](const std::string& directory) {
    return is_within(record.origin->path, directory);
  });
}

std::string BatchRun::path_of_output(const BatchMesh& mesh) const {
  return options_.writes ? command_.directory + '/' + mesh.output : "/dev/null";
}

// In which its files are written: where links lead.
std::set<std::string> BatchRun::directories_of(const BatchMesh& mesh) const {
  std::set<std::string> directories;
  for (const std::string& path : options_.written(mesh)) directories.insert(directory_of(follow_links(path)));
  return directories;
}

// Also makes the directories that outputs go to.
std::vector<SupervisedJob> BatchRun::make_jobs() const {
  std::vector<SupervisedJob> jobs;
  for (const PlannedMesh& planned : work_.plan.todo) {
    const std::string output = path_of_output(planned.mesh);
    std::error_code error;  // where it matters, the worker will notice and say so
    if (options_.writes) fs::create_directories(fs::path(output).parent_path(), error);
    jobs.push_back({planned.mesh.path, output, planned.mesh.stamp, directories_of(planned.mesh)});
  }
  return jobs;
}

// Whether to go on.
bool BatchRun::take(std::size_t job, JobResult result, double part) {
  const BatchMesh& mesh = work_.plan.todo[job].mesh;
  const std::vector<std::string> warnings = std::move(result.warnings);
  BatchRecord record = record_of(mesh, std::move(result));
  results_.append(record);
  const bool failed = record.row.status != MeshStatus::kOk;
  if (failed || !warnings.empty()) progress_.erase();
  if (failed) print_message(record.row.message);
  for (const std::string& warning : warnings) {
    if (!command_.run.quiet) print_message("warning: " + mesh.path + ": " + warning);
  }
  progress_.add(record.row.status, part);
  outcome_.evaluated.insert_or_assign(mesh.name, std::move(record));
  return !(failed && command_.fail_fast);
}

BatchRecord BatchRun::record_of(const BatchMesh& mesh, JobResult result) const {
  ResultRow& row = result.row;
  row.mesh = mesh.name;
  if (!result.knows_inputs) row.sha256.clear();
  row.message = plain_text(row.message, "?");  // a mesh's name in it may have line feeds
  if (row.status == MeshStatus::kOk && options_.writes) row.output = mesh.output;
  RowOrigin origin{.stamp = result.knows_inputs ? result.stamp : kNoStamp,
                   .buffers = std::move(result.buffers),
                   .written = std::move(result.written),
                   .version = options_.version,
                   .options = options_with_grid(command_, result.grid),
                   .memory_limit = options_.memory_limit,
                   .default_memory_limit = options_.default_memory_limit,
                   .timeout = options_.timeout,
                   .finished = time_after(starts_.at(mesh.name)),
                   .thumbnail = std::move(result.thumbnail),
                   .path = path_from_root(mesh)};
  return {std::move(row), std::move(origin)};
}

void BatchRun::keep_results() {
  outcome_.kept = work_.plan.kept;
  outcome_.not_done = work_.plan.todo.size() - outcome_.evaluated.size();
  BatchRecords records = outcome_.kept;
  for (const auto& [mesh, record] : outcome_.evaluated) records.insert_or_assign(mesh, record);
  results_.merge(records);
}

}  // namespace raycone
