// The supervisor's end of a worker.
#pragma once

#include <sys/types.h>

#include <optional>

#include "app/batch/job_result.h"
#include "app/process/message.h"
#include "io/files/descriptor.h"

namespace raycone {

// A worker that runs; killed, with nothing left of it, at the end of its life, and when this process dies, however it
// does. To be used by the thread that started it, the only one of its process.
class WorkerProcess {
 public:
  // Starts this executable. Throws LimitError.
  WorkerProcess();
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  // Readable when an answer arrives, or at the worker's end.
  [[nodiscard]] int descriptor() const { return socket_.number(); }

  // To an idle worker. False where it has ended.
  [[nodiscard]] bool send(const Message& message) const;
  // Takes what has arrived: the answer, once it is complete. Nothing to be understood ends the worker.
  [[nodiscard]] std::optional<JobResult> receive();
  [[nodiscard]] bool ended() const { return ended_; }
  // Whether that is why it has ended.
  [[nodiscard]] bool is_damaged() const { return is_damaged_; }

  // Has it end, without waiting for that.
  void kill();
  // Ends it, if need be, and returns how it ended, as wait(2) tells. One that hangs in the kernel, as on a file system
  // that does not answer, is given a minute, then left to itself: kDoesNotEnd.
  int end();
  static constexpr int kDoesNotEnd = -1;

 private:
  pid_t process_ = -1;
  Descriptor socket_;
  bool ended_ = false, is_damaged_ = false;
  MessageReader reader_;
};

}  // namespace raycone
