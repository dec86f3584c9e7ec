// Everything called by the handlers is async-signal-safe (signal-safety(7)).
#include "app/process/signals.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/time.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "app/process/exit_code.h"
#include "app/process/messages.h"
#include "io/files/file_error.h"
#include "io/files/temporary_file.h"

namespace raycone {
namespace {

// setitimer(2) need not accept more.
constexpr double kMaxTimeout = 1e8;

// What others send to end a process, or to tell it so before they do (batch systems: SIGUSR1 and SIGUSR2), and what
// ends it though nobody meant it.
constexpr std::array kInterruptions{SIGINT,  SIGTERM,   SIGHUP,  SIGQUIT, SIGUSR1, SIGUSR2,
                                    SIGALRM, SIGVTALRM, SIGPROF, SIGPOLL, SIGPWR,  SIGSTKFLT};
struct Fault {
  int signal;
  const char* description;
};
constexpr std::array kFaults{
    Fault{SIGSEGV, "Segmentation fault"},      Fault{SIGBUS, "Bus error"}, Fault{SIGILL, "Illegal instruction"},
    Fault{SIGFPE, "Floating point exception"}, Fault{SIGABRT, "Aborted"},  Fault{SIGSYS, "Bad system call"},
    Fault{SIGTRAP, "Trace/breakpoint trap"}};

// A handler can reach nothing else; written before the timer starts, constant afterwards.
char timeout_message[8192];

void write_to_stderr(const char* text) {
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody left to tell
}

// The progress line, if any, must not stay in front of what follows.
void erase_progress_line() {
  termios settings{};
  const bool is_terminal = tcgetattr(STDERR_FILENO, &settings) == 0;
  if (is_terminal) write_to_stderr("\r\033[K");
}

// Installed with SA_RESETHAND: the signal raised again takes its default action as soon as this returns.
extern "C" void clean_up_and_die(int signal) {
  const int interrupted = errno;
  remove_temporary_files();
  if (signal != SIGPIPE) erase_progress_line();
  raise(signal);
  errno = interrupted;
}

// The same for what only a fault of raycone or its libraries raises; a dump of memory is for whoever looks for it.
extern "C" void clean_up_and_crash(int signal) {
  remove_temporary_files();
  erase_progress_line();
  write_to_stderr("raycone: internal error, please report: ");
  for (const Fault& fault : kFaults) {
    if (fault.signal == signal) write_to_stderr(fault.description);
  }
  write_to_stderr("\n");
  raise(signal);
}

extern "C" void time_out(int /*signal*/) {
  remove_temporary_files();
  erase_progress_line();
  write_to_stderr(timeout_message);
  _exit(static_cast<int>(ExitCode::kLimit));
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_ONSTACK);
  sigfillset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

// The main thread's handlers need a stack of their own where its stack has overflowed.
void prepare_handler_stack() {
  static std::array<char, 1U << 16> memory;
  stack_t stack{};
  stack.ss_sp = memory.data();
  stack.ss_size = memory.size();
  sigaltstack(&stack, nullptr);
}

bool is_set_to(int signal, void (*handler)(int)) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == handler;
}

// A write to a closed standard output shall fail, not go to whatever file got its number.
void occupy_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) != -1) continue;
    if (open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

// Libraries that read these would print lines of their own, some of them on standard output. Before there are threads.
void forget_settings_of_libraries() {
  for (const char* const name :
       {"TBB_VERSION", "BLOSC_PRINT_SHUFFLE_ACCEL", "BLOSC_WARN", "LOG4CPLUS_LOGLOG_DEBUGENABLED",
        "LOG4CPLUS_LOGLOG_QUIETMODE", "EXPAT_ACCOUNTING_DEBUG", "EXPAT_ENTITY_DEBUG", "EXPAT_ENTROPY_DEBUG"}) {
    unsetenv(name);
  }
}

}  // namespace

void set_up_process() {
  forget_settings_of_libraries();
  occupy_standard_descriptors();
  prepare_handler_stack();
  // What the caller ignores stays ignored, and what a preloaded library handles (profilers, sanitizers) stays its own.
  for (const int signal : kInterruptions) {
    if (is_set_to(signal, SIG_DFL)) handle(signal, clean_up_and_die);
  }
  for (const Fault& fault : kFaults) {
    if (is_set_to(fault.signal, SIG_DFL)) handle(fault.signal, clean_up_and_crash);
  }
  handle(SIGXCPU, clean_up_and_die);
  handle(SIGPIPE, clean_up_and_die);
  signal(SIGXFSZ, SIG_IGN);
  signal(SIGCHLD, SIG_DFL);  // where it is ignored, the system does not tell how children ended
  sigset_t ours;
  sigemptyset(&ours);
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU, SIGPIPE, SIGALRM}) sigaddset(&ours, signal);
  pthread_sigmask(SIG_UNBLOCK, &ours, nullptr);
}

void ignore_interruptions() {
  for (const int signal : kInterruptions) ::signal(signal, SIG_IGN);
  for (const Fault& fault : kFaults) {
    if (is_set_to(fault.signal, clean_up_and_crash)) ::signal(fault.signal, SIG_DFL);
  }
}

void start_timeout(double seconds, const std::string& name) {
  const std::string line = message_line(timeout_text(name, seconds));
  line.copy(timeout_message, sizeof timeout_message - 1);
  handle(SIGALRM, time_out);
  const double capped = std::min(seconds, kMaxTimeout);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(capped);
  timer.it_value.tv_usec = static_cast<suseconds_t>((capped - std::floor(capped)) * 1e6);
  if (timer.it_value.tv_sec == 0) timer.it_value.tv_usec = std::max<suseconds_t>(timer.it_value.tv_usec, 1);
  setitimer(ITIMER_REAL, &timer, nullptr);
}

bool interruption_waits() {
  sigset_t waiting;
  if (sigpending(&waiting) != 0) return false;
  const auto waits = [&](int signal) { return sigismember(&waiting, signal) == 1; };
  return std::ranges::any_of(kInterruptions, waits) || waits(SIGXCPU) || waits(SIGPIPE);
}

HeldSignals::HeldSignals() {
  sigset_t held;
  sigemptyset(&held);
  const auto hold = [&held](int signal) {
    if (is_set_to(signal, clean_up_and_die)) sigaddset(&held, signal);
  };
  for (const int signal : kInterruptions) hold(signal);
  hold(SIGXCPU);
  hold(SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
  descriptor_ = Descriptor(signalfd(-1, &held, SFD_NONBLOCK | SFD_CLOEXEC));
  if (descriptor_) return;
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  throw LimitError("cannot wait for signals: " + std::generic_category().message(error));
}

HeldSignals::~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

int HeldSignals::take() const {
  signalfd_siginfo info{};
  return read(descriptor_.number(), &info, sizeof info) == sizeof info ? static_cast<int>(info.ssi_signo) : 0;
}

}  // namespace raycone
