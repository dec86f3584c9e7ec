#include "app/batch/supervisor.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "app/batch/command_message.h"
#include "app/batch/worker_failure.h"
#include "app/batch/worker_process.h"
#include "app/process/signals.h"
#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/files/file_time.h"
#include "io/files/temporary_file.h"
#include "io/mesh/read_mesh.h"

namespace raycone {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTick{250};

MeshCommand command_for(const SupervisedJob& job, int threads, const SupervisorOptions& options) {
  MeshCommand command = options.for_each;
  const auto fill_in = [&](auto& one) {
    one.mesh.path = job.mesh;
    one.output.path = job.output;
    one.run.threads = threads;
    one.run.memory_limit = options.memory_limit;
  };
  std::visit(fill_in, command);
  return command;
}

const ReadMeshOptions& reading_of(const MeshCommand& command) {
  return std::visit([](const auto& one) -> const ReadMeshOptions& { return one.mesh.reading; }, command);
}

Clock::duration seconds(double count) {
  constexpr double kMost = 1e9;  // 30 years: what clocks can add
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(count, kMost)));
}

// Throws LimitError where so few are left that another worker would take those of the tables of results.
void require_descriptors() {
  constexpr int kSpare = 12;
  const Descriptor lowest(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0));
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (!lowest || limit.rlim_cur < static_cast<rlim_t>(lowest.number()) + kSpare) throw LimitError("too few open files");
}

// A worker and what it is doing.
struct Slot {
  std::unique_ptr<WorkerProcess> worker;
  std::optional<Schedule::Start> running;
  std::optional<JobResult> unhashed;  // all is done but for the hashes of what was read
  std::int64_t started = 0;           // nanoseconds since 1970
  Clock::time_point deadline;
};

class Supervisor {
 public:
  Supervisor(const std::vector<SupervisedJob>& jobs, const SupervisorOptions& options, const ResultHandler& handle)
      : jobs_(jobs), options_(options), handle_(handle), schedule_(sizes_of(jobs), options.threads, options.jobs) {}

  int run(const HeldSignals& signals, const std::function<void()>& tick) {
    for (;;) {
      if (stopped_) return 0;
      while (const std::optional<Schedule::Start> start = schedule_.next()) begin(*start);
      if (none_runs()) return 0;
      put_off_deadlines(wait(signals));
      if (const int signal = signals.take()) {
        for (Slot& slot : slots_) finish_unhashed(slot);
        return signal;
      }
      for (Slot& slot : slots_) attend_to(slot);
      tick();
    }
  }

  // Ends the workers that still run; what they were doing is not done.
  ~Supervisor() {
    for (const Slot& slot : slots_) {
      if (slot.worker) slot.worker->kill();
    }
    for (Slot& slot : slots_) replace(slot);
  }

  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

 private:
  static std::vector<std::uint64_t> sizes_of(const std::vector<SupervisedJob>& jobs) {
    std::vector<std::uint64_t> sizes;
    for (const SupervisedJob& job : jobs) sizes.push_back(job.stamp.size);
    return sizes;
  }

  Slot& idle_slot() {
    const auto idle = std::ranges::find_if(slots_, [](const Slot& slot) { return !slot.running; });
    return idle != slots_.end() ? *idle : slots_.emplace_back();
  }

  void begin(const Schedule::Start& start) {
    Slot& slot = idle_slot();
    try {
      if (!slot.worker && !none_runs()) require_descriptors();
      ask(slot, to_message(command_for(jobs_[start.mesh], start.threads, options_)));
      slot.running = start;
      slot.started = nanoseconds_now();
      slot.deadline = Clock::now() + seconds(options_.timeout);
    } catch (const LimitError&) {
      if (none_runs()) throw;
      schedule_.put_off(start);  // those that run will do it
      std::erase_if(slots_, [](const Slot& one) { return !one.worker; });
    }
  }

  [[nodiscard]] bool none_runs() const {
    return std::ranges::none_of(slots_, [](const Slot& slot) { return slot.running.has_value(); });
  }

  // A worker may have ended since it answered. Throws LimitError.
  static void ask(Slot& slot, const Message& message) {
    if (slot.worker && slot.worker->send(message)) return;
    slot.worker = std::make_unique<WorkerProcess>();
    static_cast<void>(slot.worker->send(message));  // of one that has ended again the end is seen
  }

  // Until a worker or a signal has something to say, the next deadline, or the next tick. Returns by how much longer it
  // took than it should.
  [[nodiscard]] Clock::duration wait(const HeldSignals& signals) const {
    std::vector<pollfd> descriptors{{signals.descriptor(), POLLIN, 0}};
    Clock::duration patience = kTick;
    for (const Slot& slot : slots_) {
      if (!slot.running) continue;
      descriptors.push_back({slot.worker->descriptor(), POLLIN, 0});
      patience = std::min(patience, slot.deadline - Clock::now());
    }
    patience = std::max(patience, Clock::duration::zero());
    const auto milliseconds = std::chrono::ceil<std::chrono::milliseconds>(patience).count();
    const Clock::time_point begun = Clock::now();
    poll(descriptors.data(), descriptors.size(), static_cast<int>(milliseconds));
    return Clock::now() - begun - patience;
  }

  // A batch that was suspended, as a terminal or a batch system does it to the whole group, has not used that time.
  void put_off_deadlines(Clock::duration overdue) {
    constexpr std::chrono::seconds kSuspended{1};
    if (overdue < kSuspended) return;
    for (Slot& slot : slots_) slot.deadline += overdue;
  }

  void attend_to(Slot& slot) {
    if (!slot.running || stopped_) return;
    if (slot.unhashed) return attend_to_hash(slot);
    if (std::optional<JobResult> result = slot.worker->receive()) {
      const MeshStatus status = result->row.status;
      const bool reusable =
          status == MeshStatus::kOk || status == MeshStatus::kInvalid || status == MeshStatus::kUnwritable;
      if (!reusable) replace(slot);
      hash(slot, std::move(*result));
    } else if (slot.worker->ended()) {
      const std::string& mesh = jobs_[slot.running->mesh].mesh;
      const bool is_damaged = slot.worker->is_damaged();
      const int wait_status = replace(slot);
      hash(slot, killed(slot, is_damaged ? damaged_answer(mesh) : died(mesh, wait_status, options_.memory_limit)));
    } else if (Clock::now() >= slot.deadline) {
      replace(slot);
      hash(slot, killed(slot, timed_out(jobs_[slot.running->mesh].mesh, options_.timeout)));
    }
  }

  // Its worker cannot tell what it found.
  [[nodiscard]] JobResult killed(const Slot& slot, JobResult result) const {
    result.stamp = jobs_[slot.running->mesh].stamp;
    return result;
  }

  // Has the inputs of a result hashed that does not tell their hashes: by a worker, as reading may take long or hang.
  // A mesh without a hash may be done again in each run, so that a short time limit is not one for this.
  void hash(Slot& slot, JobResult result) {
    constexpr double kLeast = 10.0;  // seconds
    constexpr double kMost = 60.0;
    if (!result.row.sha256.empty() || !result.knows_inputs) return finish(slot, std::move(result));
    const SupervisedJob& job = jobs_[slot.running->mesh];
    const FileStamp stamp = result.stamp;
    slot.unhashed = std::move(result);
    slot.deadline = Clock::now() + seconds(std::clamp(options_.timeout, kLeast, kMost));
    try {
      ask(slot, to_message(InputsRequest{command_for(job, slot.running->threads, options_), stamp, slot.started}));
    } catch (const LimitError&) {
      finish_unhashed(slot);
    }
  }

  void attend_to_hash(Slot& slot) {
    if (std::optional<JobResult> inputs = slot.worker->receive()) {
      JobResult result = *std::exchange(slot.unhashed, std::nullopt);
      result.knows_inputs = inputs->knows_inputs;
      result.row.sha256 = std::move(inputs->row.sha256);
      result.buffers = std::move(inputs->buffers);
      result.grid = std::move(inputs->grid);
      return finish(slot, std::move(result));
    } else if (slot.worker->ended() || Clock::now() >= slot.deadline) {
      replace(slot);
    } else {
      return;
    }
    finish_unhashed(slot);
  }

  // Nobody told what was read. Without a hash a mesh is the same only as long as its stamp is, and if that is all.
  void finish_unhashed(Slot& slot) {
    if (!slot.unhashed) return;
    JobResult result = *std::exchange(slot.unhashed, std::nullopt);
    result.knows_inputs = !may_refer_to_files(jobs_[slot.running->mesh].mesh, reading_of(options_.for_each));
    finish(slot, std::move(result));
  }

  // Ends the worker and removes what it was writing. Returns how it ended.
  int replace(Slot& slot) {
    if (!slot.worker) return 0;
    const int status = slot.worker->end();
    slot.worker.reset();
    if (slot.running) std::ranges::for_each(jobs_[slot.running->mesh].directories, remove_abandoned_files);
    return status;
  }

  void finish(Slot& slot, JobResult result) {
    const Schedule::Start start = *std::exchange(slot.running, std::nullopt);
    schedule_.finished(start);
    stopped_ = !handle_(start.mesh, std::move(result), schedule_.progress());
  }

  const std::vector<SupervisedJob>& jobs_;
  const SupervisorOptions& options_;
  const ResultHandler& handle_;
  Schedule schedule_;
  std::vector<Slot> slots_;
  bool stopped_ = false;
};

}  // namespace

int supervise(const std::vector<SupervisedJob>& jobs, const SupervisorOptions& options, const HeldSignals& signals,
              const ResultHandler& handle, const std::function<void()>& tick) {
  return Supervisor(jobs, options, handle).run(signals, tick);
}

}  // namespace raycone
