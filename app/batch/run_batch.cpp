// Straight lines: meshes found, what is up to date left out, the others handed to workers, results kept.
#include "app/batch/run_batch.h"

#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/batch/batch_files.h"
#include "app/batch/batch_meshes.h"
#include "app/batch/batch_run.h"
#include "app/batch/batch_summary.h"
#include "app/batch/plan.h"
#include "app/batch/prune.h"
#include "app/batch/results_files.h"
#include "app/batch/shard.h"
#include "app/batch/supervisor.h"
#include "app/input/grid_lattice.h"
#include "app/process/default_threads.h"
#include "app/process/memory_limit.h"
#include "app/process/messages.h"
#include "app/process/usage_error.h"
#include "app/process/version.h"
#include "app/text/plain_text.h"
#include "io/files/file_error.h"
#include "io/files/output_file.h"
#include "io/files/read_file.h"

namespace raycone {
namespace {

namespace fs = std::filesystem;

void warn(const BatchCommand& command, const std::string& text) {
  if (!command.run.quiet) print_message("warning: " + text);
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
          .options = options_with_grid(command, grid ? sha256_of_file(grid->path) : ""),
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

// Where standard error can be written to at once: who interrupts does not wait, and may have closed it.
void print_how_far(const BatchOutcome& outcome) {
  pollfd standard_error{STDERR_FILENO, POLLOUT, 0};
  if (poll(&standard_error, 1, 0) != 1 || standard_error.revents != POLLOUT) return;
  print_message("interrupted: " + summary_line(outcome) + (outcome.not_done > 0 ? "; run it again to go on" : ""));
}

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
  BatchRun run(command, options, {all.directories, std::move(plan), std::move(gone)});
  if (const int signal = run.run(limits)) {
    if (!command.run.quiet) print_how_far(run.outcome());
    raise(signal);
  }
  if (!command.run.quiet) print_message(summary_line(run.outcome()));
  return run.outcome().any_failed() && !command.exit_zero ? ExitCode::kBatch : ExitCode::kDone;
}

}  // namespace raycone
