#include "app/process/stack_limit.h"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace raycone {
namespace {

constexpr rlim_t kKilobyte = 1024;
// With 64 kB all commands were seen to work, with 32 kB OpenVDB's libraries overflow while they are loaded.
constexpr rlim_t kNeeded = 256 * kKilobyte;
constexpr rlim_t kComfortable = 8192 * kKilobyte;  // what systems grant

}  // namespace

bool ensure_stack() {
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kNeeded) return true;
  limit.rlim_cur = std::min(limit.rlim_max, kComfortable);
  if (limit.rlim_cur < kNeeded || setrlimit(RLIMIT_STACK, &limit) != 0) {
    constexpr std::string_view kMessage = "raycone: the stack is too small, expected 256 kB or more (ulimit -s)\n";
    [[maybe_unused]] const ssize_t told = write(STDERR_FILENO, kMessage.data(), kMessage.size());
    return false;
  }
  // Threads take the limit that there was when the process began, unless told otherwise.
  pthread_attr_t attributes;
  if (pthread_getattr_default_np(&attributes) != 0) return true;
  pthread_attr_setstacksize(&attributes, static_cast<std::size_t>(limit.rlim_cur));
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
  return true;
}

}  // namespace raycone
