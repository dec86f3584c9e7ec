// Straight lines: meshes found, what is up to date left out, the others handed to workers, results kept.
#include "app/batch/run_batch.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/batch/batch_marker.h"
#include "app/batch/batch_progress.h"
#include "app/batch/batch_summary.h"
#include "app/batch/plan.h"
#include "app/batch/prune.h"
#include "app/batch/results_files.h"
#include "app/batch/shard.h"
#include "app/batch/supervisor.h"
#include "app/input/grid_lattice.h"
#include "app/input/written_files.h"
#include "app/process/default_threads.h"
#include "app/process/memory_limit.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "app/process/stopwatch.h"
#include "app/process/usage_error.h"
#include "app/process/version.h"
#include "app/text/plain_text.h"
#include "io/files/file_error.h"
#include "io/files/file_identity.h"
#include "io/files/file_time.h"
#include "io/files/output_file.h"
#include "io/files/read_file.h"
#include "io/files/temporary_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

void warn(const BatchCommand& command, const std::string& text) {
  if (!command.run.quiet) print_message("warning: " + text);
}

// Files that the batch reads beside the meshes: lists, the grid of --like.
std::vector<std::string> other_inputs(const BatchCommand& command) {
  std::vector<std::string> inputs;
  for (const std::string& operand : command.search.operands) {
    if (operand == "-") inputs.push_back(operand);
    if (operand.starts_with('@')) inputs.push_back(operand.substr(1));
  }
  if (const GridReference* const grid = grid_of(command.for_each)) inputs.push_back(grid->path);
  return inputs;
}

// All that a job writes for a mesh, its output first.
std::vector<std::string> paths_written(const BatchCommand& command, const BatchMesh& mesh) {
  if (!command.writes) return {};
  std::vector<std::string> paths{command.directory + '/' + mesh.output};
  const auto* const for_each = std::get_if<LatticeCommand>(&command.for_each);
  if (!for_each || !for_each->field.has(Field::kLabel)) return paths;
  LatticeCommand one = *for_each;
  one.output.path = paths.front();
  if (const std::optional<std::string> names = label_names_path(one)) paths.push_back(*names);
  return paths;
}

// No output may replace an input of this or another mesh, nor go where links lead another output.
void refuse_to_replace(const BatchCommand& command, const std::vector<BatchMesh>& meshes) {
  std::map<std::pair<dev_t, ino_t>, std::string> inputs;  // their names
  const auto add = [&inputs](const std::string& path) {
    if (const auto file = identity_of_input(path)) inputs.emplace(std::pair(file->device, file->inode), path);
  };
  for (const BatchMesh& mesh : meshes) add(mesh.path);
  for (const std::string& path : other_inputs(command)) add(path);
  std::map<std::string, std::string> outputs;  // by the path where links lead
  const auto check = [&](const BatchMesh& mesh, const std::string& path) {
    const std::optional<FileIdentity> file = identity_of_output(path);
    if (!file) return;
    const auto input = inputs.find({file->device, file->inode});
    const bool is_input = file->new_name.empty() && input != inputs.end();
    const fs::path target = follow_links(path);
    std::error_code error;
    const fs::path target_path = fs::canonical(directory_of(target.string()), error) / target.filename();
    const auto [other, is_free] = outputs.emplace(target_path.string(), mesh.path);
    if (is_input) throw UsageError(mesh.path + ": its output " + path + " would replace the input " + input->second);
    if (!is_free) throw UsageError(mesh.path + ": its output " + path + " would replace that of " + other->second);
  };
  for (const BatchMesh& mesh : meshes) {
    for (const std::string& path : paths_written(command, mesh)) check(mesh, path);
  }
}

FoundMeshes all_meshes_of(const BatchCommand& command) {
  FoundMeshes all = find_meshes(command.search);
  if (all.meshes.empty()) warn(command, std::string("no meshes found") + (command.prune ? ", no rows removed" : ""));
  for (const BatchMesh& mesh : all.meshes) {
    if (!command.writes || !is_results_file(fs::path(mesh.output).filename().string())) continue;
    throw UsageError(mesh.path + ": its output " + mesh.output +
                     " would have the name of a table of results; --full-names keeps them apart");
  }
  if (command.writes) refuse_to_replace(command, all.meshes);
  return all;
}

std::vector<BatchMesh> meshes_of(const std::optional<Shard>& shard, const std::vector<BatchMesh>& all) {
  if (!shard) return all;
  std::vector<SizedName> names;
  for (const BatchMesh& mesh : all) names.push_back({mesh.name, mesh.stamp.size});
  std::vector<BatchMesh> part;
  for (const std::size_t i : part_of(names, *shard)) part.push_back(all[i]);
  return part;
}

// A row that says so would be one of those to be removed.
void leave_out_missing(const BatchCommand& command, std::vector<BatchMesh>& meshes) {
  const auto missing = std::ranges::find_if(meshes, is_missing);
  if (missing == meshes.end()) return;
  const std::string first = missing->path;
  const std::size_t count = std::erase_if(meshes, is_missing);
  warn(command,
       first + (count > 1 ? " and " + std::to_string(count - 1) + " more" : "") + ": not there, left out (--prune)");
}

// Where nothing at all is found, a file system is rather not mounted.
GoneMeshes gone_from(const BatchCommand& command, const BatchRecords& records, const std::vector<BatchMesh>& found) {
  if (!command.prune || found.empty()) return {};
  // The tables of others are theirs.
  return gone_meshes(command.shard ? ResultsFiles(command.directory, command.shard).read() : records, found);
}

// What outputs and results depend on beside the mesh, as text. `grid`: the hash of that of --like.
std::string result_options(const BatchCommand& command, const std::string& grid) {
  return grid_of(command.for_each) ? command.result_options + '\n' + grid : command.result_options;
}

SupervisorOptions supervisor_options(const BatchCommand& command) {
  constexpr double kDefaultTimeout = 3600.0;  // seconds
  SupervisorOptions options;
  options.for_each = command.for_each;
  options.threads = command.run.threads ? *command.run.threads : default_threads();
  options.jobs = std::min({command.jobs.value_or(options.threads), options.threads, kMaxJobs});
  options.memory_limit =
      command.run.memory_limit ? *command.run.memory_limit : available_memory(static_cast<std::uint64_t>(options.jobs));
  options.timeout = command.run.timeout.value_or(kDefaultTimeout);
  return options;
}

PlanOptions plan_options(const BatchCommand& command, const SupervisorOptions& limits) {
  const GridReference* const grid = grid_of(command.for_each);
  if (grid) static_cast<void>(lattice_of_grid(*grid));  // what no mesh could have is told once
  return {.written = [&command](const BatchMesh& mesh) { return paths_written(command, mesh); },
          .writes = command.writes,
          .retry_failed = command.retry_failed,
          .version = kVersion,
          .options = result_options(command, grid ? sha256_of_file(grid->path) : ""),
          .memory_limit = limits.memory_limit,
          .default_memory_limit = !command.run.memory_limit,
          .timeout = limits.timeout};
}

// For programs names as they are, for people such that no terminal is moved.
void print_plan(const Plan& plan, const GoneMeshes& gone) {
  const bool for_people = isatty(STDOUT_FILENO) == 1;
  OutputFile standard_output("-");
  const auto print = [&](const std::string& path, const std::string& reason) {
    standard_output.stream() << (for_people ? plain_text(path, "?") : path) << '\t' << reason << '\n';
  };
  for (const PlannedMesh& planned : plan.todo) print(planned.mesh.path, planned.reason);
  for (const auto& [name, path] : gone) print(path, "gone");
  standard_output.commit();
}

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw OutputError(path + ": cannot create the directory: " + error.message());
}

// One batch run, from its plan to its results.
class BatchRun {
 public:
  // `directories`: those that were searched.
  BatchRun(const BatchCommand& command, const std::vector<std::string>& directories, Plan plan, GoneMeshes gone,
           const PlanOptions& options)
      : command_(command),
        directories_(directories),
        plan_(std::move(plan)),
        gone_(std::move(gone)),
        options_(options),
        results_(command.directory, command.shard),
        progress_(progress_style(command.run.progress, command.run.quiet), plan_.todo.size()) {}

  // Returns the signal that interrupted it, or 0.
  int run(const SupervisorOptions& limits) {
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
    outcome_.kept = plan_.kept;
    outcome_.not_done = plan_.todo.size() - outcome_.evaluated.size();
    BatchRecords records = outcome_.kept;
    for (const auto& [mesh, record] : outcome_.evaluated) records.insert_or_assign(mesh, record);
    results_.merge(records);
    return signal;
  }

  [[nodiscard]] const BatchOutcome& outcome() const { return outcome_; }

 private:
  void remove_gone() {
    if (gone_.empty()) return;
    std::set<std::string> names;
    for (const auto& [name, path] : gone_) names.insert(name);
    if (command_.shard) {
      results_.remove(names);
    } else {
      remove_from_all_results(command_.directory, names);
    }
    outcome_.pruned = names.size();
  }

  // What killed runs left where outputs are, or will be.
  void remove_debris() const {
    std::set<std::string> directories{command_.directory};
    for (const auto& [name, record] : read_all_results(command_.directory)) {
      if (!record.row.output.empty())
        directories.insert(directory_of(follow_links(command_.directory + '/' + record.row.output)));
    }
    for (const PlannedMesh& planned : plan_.todo) directories.merge(directories_of(planned.mesh));
    std::ranges::for_each(directories, remove_abandoned_files);
  }

  // Of meshes that are about to be evaluated again.
  void forget_rows() {
    for (const PlannedMesh& planned : plan_.todo) starts_.emplace(planned.mesh.name, time_after(planned.earlier));
    for (const auto& [name, record] : results_.read()) {
      const bool is_of_directory = name.ends_with('/') && !plan_.kept.contains(name);
      if (is_of_directory && was_searched(record)) starts_.emplace(name, time_after(finished(record)));
    }
    results_.forget(starts_);
  }

  // Whether a directory that could not be read then is one of ours; who else it is of will look there again.
  [[nodiscard]] bool was_searched(const BatchRecord& record) const {
    return !record.origin || std::ranges::any_of(directories_, [&record](const std::string& directory) {
      return is_within(record.origin->path, directory);
    });
  }

  [[nodiscard]] std::string path_of_output(const BatchMesh& mesh) const {
    return options_.writes ? command_.directory + '/' + mesh.output : "/dev/null";
  }

  // In which its files are written: where links lead.
  [[nodiscard]] std::set<std::string> directories_of(const BatchMesh& mesh) const {
    std::set<std::string> directories;
    for (const std::string& path : options_.written(mesh)) directories.insert(directory_of(follow_links(path)));
    return directories;
  }

  // Also makes the directories that outputs go to.
  [[nodiscard]] std::vector<SupervisedJob> make_jobs() const {
    std::vector<SupervisedJob> jobs;
    for (const PlannedMesh& planned : plan_.todo) {
      const std::string output = path_of_output(planned.mesh);
      std::error_code error;  // where it matters, the worker will notice and say so
      if (options_.writes) fs::create_directories(fs::path(output).parent_path(), error);
      jobs.push_back({planned.mesh.path, output, planned.mesh.stamp, directories_of(planned.mesh)});
    }
    return jobs;
  }

  // Whether to go on.
  bool take(std::size_t job, JobResult result, double part) {
    const BatchMesh& mesh = plan_.todo[job].mesh;
    const std::vector<std::string> warnings = std::move(result.warnings);
    BatchRecord record = record_of(mesh, std::move(result));
    results_.append(record);
    const bool failed = record.row.status != MeshStatus::kOk;
    if (failed || !warnings.empty()) progress_.erase();
    if (failed) print_message(record.row.message);
    for (const std::string& warning : warnings) warn(command_, mesh.path + ": " + warning);
    progress_.add(failed, part);
    outcome_.evaluated.insert_or_assign(mesh.name, std::move(record));
    return !(failed && command_.fail_fast);
  }

  [[nodiscard]] BatchRecord record_of(const BatchMesh& mesh, JobResult result) const {
    ResultRow& row = result.row;
    row.mesh = mesh.name;
    if (!result.knows_inputs) row.sha256.clear();
    row.message = plain_text(row.message, "?");  // a mesh's name in it may have line feeds
    if (row.status == MeshStatus::kOk && options_.writes) row.output = mesh.output;
    RowOrigin origin{.stamp = result.knows_inputs ? result.stamp : kNoStamp,
                     .buffers = std::move(result.buffers),
                     .written = std::move(result.written),
                     .version = options_.version,
                     .options = result_options(command_, result.grid),
                     .memory_limit = options_.memory_limit,
                     .default_memory_limit = options_.default_memory_limit,
                     .timeout = options_.timeout,
                     .finished = time_after(starts_.at(mesh.name)),
                     .thumbnail = std::move(result.thumbnail),
                     .path = path_from_root(mesh)};
    return {std::move(row), std::move(origin)};
  }

  // Now, or where clocks differ or are set back at least later than `earlier`: nanoseconds since 1970.
  static std::int64_t time_after(std::int64_t earlier) { return std::max(nanoseconds_now(), earlier + 1); }

  const BatchCommand& command_;
  const std::vector<std::string>& directories_;
  Plan plan_;
  GoneMeshes gone_;
  const PlanOptions& options_;
  ResultsFiles results_;
  BatchProgress progress_;
  Starts starts_;  // of all that is to be done
  BatchOutcome outcome_;
};

}  // namespace

ExitCode run_batch(const BatchCommand& command) {
  const FoundMeshes all = all_meshes_of(command);
  std::vector<BatchMesh> meshes = meshes_of(command.shard, all.meshes);
  if (command.prune) leave_out_missing(command, meshes);
  const SupervisorOptions limits = supervisor_options(command);
  const PlanOptions options = plan_options(command, limits);
  const BatchRecords records = read_all_results(command.directory);
  if (!command.run.quiet) warn_of_unreadable_rows(command.directory);
  Plan plan = make_plan(meshes, records, options);
  GoneMeshes gone = gone_from(command, records, all.meshes);
  if (command.dry_run) {
    print_plan(plan, gone);
    return ExitCode::kDone;
  }
  make_directory(command.directory);
  BatchRun run(command, all.directories, std::move(plan), std::move(gone), options);
  if (const int signal = run.run(limits)) raise(signal);
  if (!command.run.quiet) print_message(summary_line(run.outcome()));
  return run.outcome().any_failed() && !command.exit_zero ? ExitCode::kBatch : ExitCode::kDone;
}

}  // namespace raycone
