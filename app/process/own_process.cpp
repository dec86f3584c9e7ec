#include "app/process/own_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace raycone {
namespace {

// In the child: async-signal-safe calls only.
[[noreturn]] void become(char* const* words, pid_t parent, const std::function<void()>& prepare) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent died before this could notice
  prepare();
  execv("/proc/self/exe", words);
  _exit(errno == ENOMEM || errno == EAGAIN ? kNotStarted : kNotExecuted);
}

}  // namespace

pid_t start_anew(const std::vector<std::string>& words, const std::function<void()>& prepare) {
  std::vector<std::string> all{"raycone"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process == 0) become(arguments.data(), parent, prepare);
  if (process < 0) throw std::system_error(errno, std::generic_category());
  return process;
}

}  // namespace raycone
