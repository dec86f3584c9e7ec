// The process of a batch that starts workers, hands them meshes and sees to it that none outlives its limits.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "app/batch/file_stamp.h"
#include "app/batch/job_result.h"
#include "app/batch/schedule.h"
#include "app/options/batch_command.h"
#include "app/process/signals.h"

namespace raycone {

struct SupervisedJob {
  std::string mesh;                     // file to read
  std::string output;                   // file to write
  FileStamp stamp;                      // of the mesh, before anything was done
  std::set<std::string> directories{};  // in which files are written: where links lead
};

struct SupervisorOptions {
  MeshCommand for_each;            // what is done to each mesh, but for its files, threads and memory
  int threads = 1;                 // busy ones at a time, in all workers together
  int jobs = 1;                    // meshes at a time
  std::uint64_t memory_limit = 0;  // of each mesh, bytes
  double timeout = 0.0;            // of each mesh, seconds
};

// Told of each mesh, by its position, as soon as it is done, and what part of the work that makes, 0 to 1. Ends the
// batch by returning false.
using ResultHandler = std::function<bool(std::size_t job, JobResult result, double progress)>;

// Does all jobs, each in a worker process. A worker is used again after it evaluated or rejected a mesh, and replaced
// where it ran out of time or memory or crashed. Where a mesh failed, another worker is asked for the hashes of what
// was read; if it does not answer in time, the result says that they are not known. `tick` is called at least four
// times a second. Returns the one of `signals` that interrupted it, or 0. Throws LimitError where not even one worker
// can be started, and what `handle` and `tick` throw. Either way no worker is left that can be killed, nor any file
// that one was writing; meshes that were running then are not done. Call in a process of one thread.
[[nodiscard]] int supervise(const std::vector<SupervisedJob>& jobs, const SupervisorOptions& options,
                            const HeldSignals& signals, const ResultHandler& handle, const std::function<void()>& tick);

}  // namespace raycone
