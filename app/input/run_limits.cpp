#include "app/input/run_limits.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <new>

#include "app/process/default_threads.h"
#include "app/process/memory_limit.h"
#include "app/process/messages.h"
#include "app/process/signals.h"
#include "core/crossings/ray_caster.h"
#include "io/files/file_error.h"

namespace raycone {
namespace {

// Each thread may have an arena, and none uses what is free in another one's. An arena takes 64 MB of addresses at a
// time, and 128 MB for a moment. Where `ulimit -v` has none left for that, each number would get a mapping of its own.
void share_arenas(std::uint64_t memory) {
  constexpr std::uint64_t kPerArena = std::uint64_t{64} << 20, kAddressesPerArena = std::uint64_t{1} << 30;
  constexpr std::uint64_t kMostArenas = 64;
  rlimit addresses{};
  const bool are_few = getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY;
  const std::uint64_t arenas = memory / (are_few ? kAddressesPerArena : kPerArena);
  mallopt(M_ARENA_MAX, static_cast<int>(std::clamp<std::uint64_t>(arenas, 1, kMostArenas)));
}

// TBB starts as many workers as there are CPUs, now or later, however few are allowed to work, and ends the process
// where it cannot. So all are started before anything is limited; the memory cap then takes their stacks for untouched.
int with_all_workers(int threads) {
  prime_threads();
  return threads;
}

}  // namespace

RunLimits::RunLimits(const RunOptions& options, const std::string& mesh)
    : threads_(options.threads ? *options.threads : default_threads()),
      thread_limit_(with_all_workers(threads_)),
      memory_(options.memory_limit ? *options.memory_limit : available_memory()) {
  if (options.timeout) start_timeout(*options.timeout, mesh);
  share_arenas(memory_);
  prime_threads();  // of more threads than CPUs, the rest
  check_memory(mesh, 0.0, memory_);
  cap_memory(memory_);
}

void rethrow_as_limit(const std::string& mesh, const RunLimits* limits) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    throw LimitError(limits ? out_of_memory_text(mesh, limits->memory()) : mesh + ": out of memory");
  } catch (const ThreadsUnavailable& error) {
    throw UnavailableError(mesh + ": " + error.what());
  } catch (const EmbreeUnavailable& error) {
    throw UnavailableError(mesh + ": " + error.what());
  }
}

}  // namespace raycone
