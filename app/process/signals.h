// Signals and inherited descriptors of the process: interrupted runs leave no debris and die as their caller expects.
#pragma once

#include <csignal>
#include <string>

#include "io/files/descriptor.h"

namespace raycone {

// Call once, first thing. Every signal that ends a process (but SIGKILL and those of real time) removes temporary files
// first; those of faults say in a line that they are internal errors. Signals that were ignored stay so, as under
// nohup, but for SIGPIPE, SIGXCPU and SIGCHLD. A file-size limit becomes a write error; closed standard descriptors are
// occupied, so that no file is opened in their place.
void set_up_process();

// For a process whose parent decides when it ends, tells how it did, and removes its temporary files: signals that ask
// for an end do nothing. They are ignored by what it executes, too. Async-signal-safe.
void ignore_interruptions();

// Ends the process with status 4 and a message about `name` after so many seconds.
void start_timeout(double seconds, const std::string& name);

// Whether a signal waits that HeldSignals may hold.
[[nodiscard]] bool interruption_waits();

// While this lives, the signals that end a process wait until take() asks for them: for a process that must end others
// first. Those that were ignored stay so.
class HeldSignals {
 public:
  HeldSignals();   // throws LimitError where the system has no room for that
  ~HeldSignals();  // what has not been taken comes now
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  // Readable when a signal waits.
  [[nodiscard]] int descriptor() const { return descriptor_.number(); }
  // A signal that waits, or 0.
  [[nodiscard]] int take() const;

 private:
  sigset_t before_{};
  Descriptor descriptor_;
};

}  // namespace raycone
