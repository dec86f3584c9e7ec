// Reading and writing of OpenVDB files, by the module that is loaded when the first one is asked for.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <thread>

#include "io/fields/format_writers.h"
#include "io/files/descriptor.h"
#include "io/files/file_error.h"
#include "io/vdb/read_vdb.h"
#include "io/vdb/vdb_module.h"

namespace raycone {
namespace {

// A place relative to the executable, in the build directory as in an installation, which may be moved.
std::string module_path() {
  std::error_code unknown;  // is told by dlopen()
  const std::filesystem::path executable = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return executable.parent_path() / RAYCONE_MODULE_FROM_EXECUTABLE / vdb::kModuleFile;
}

void require_room(std::size_t bytes, int protection) {
  void* const room = mmap(nullptr, bytes, protection, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, bytes);
}

void* wait_for(void* gate) {
  pthread_mutex_lock(static_cast<pthread_mutex_t*>(gate));
  pthread_mutex_unlock(static_cast<pthread_mutex_t*>(gate));
  return nullptr;
}

// The C library keeps the stacks for the next threads. It would keep 64 MB of address space more for each thread that
// frees memory, as those of std::thread do.
void require_threads(const std::string& name) {
  constexpr std::size_t kNeeded = 6;  // log4cplus starts four, and others may start some meanwhile
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  std::array<pthread_t, kNeeded> trial{};
  std::size_t started = 0;
  pthread_mutex_lock(&gate);
  while (started < kNeeded && pthread_create(&trial[started], nullptr, wait_for, &gate) == 0) ++started;
  pthread_mutex_unlock(&gate);
  for (std::size_t i = 0; i < started; ++i) pthread_join(trial[i], nullptr);
  if (started < kNeeded)
    throw UnavailableError(name + ": cannot start the " + std::to_string(kNeeded) + " threads that OpenVDB needs");
}

// Where a user may have few threads, one process after the other loads the module: the trial of one would take the
// threads that another one has found free. Who has waited for ten seconds goes on all the same.
class LoadingTurn {
 public:
  LoadingTurn() {
    constexpr rlim_t kFewThreads = 1024;
    constexpr int kTries = 1000;
    rlimit limit{};
    if (getrlimit(RLIMIT_NPROC, &limit) != 0 || limit.rlim_cur >= kFewThreads) return;
    module_ = open_file(module_path(), O_RDONLY);
    for (int n = 0; module_ && n < kTries && flock(module_.number(), LOCK_EX | LOCK_NB) != 0; ++n) {
      if (errno != EWOULDBLOCK && errno != EINTR) return;  // a file system without locks
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  Descriptor module_;  // locked
};

// Where threads or memory are short, the libraries that OpenVDB brings abort or wait for ever while they are loaded,
// and the dynamic linker does not tell this from a library that is damaged: refuse before. TBB may still fail to start
// a thread, in a way that can be caught.
void require_what_loading_takes(const std::string& name) {
  require_threads(name);
  constexpr std::size_t kMegabyte = std::size_t{1} << 20;
  // The libraries take 60 MB of addresses, most of them files; the rest is for what the allocator reserves.
  require_room(160 * kMegabyte, PROT_NONE);
  // Their data, of which systems may allow less (RLIMIT_DATA): below 1 MB once loaded, the rest is for loading.
  require_room(16 * kMegabyte, PROT_READ | PROT_WRITE);
}

// OpenVDB's log library, where it has one, starts four threads that never do anything. A batch has many processes that
// wait, and `--threads` is a promise about all of them.
void end_idle_threads(void* library) {
  constexpr const char* kShutdown = "_ZN9log4cplus18shutdownThreadPoolEv";  // Debian has its header in another package
  if (void* const shutdown = dlsym(library, kShutdown)) reinterpret_cast<void (*)()>(shutdown)();
}

std::atomic<bool> is_loaded = false;

// `name`: the file that asks for it. Throws std::bad_alloc, UnavailableError, and Error where the module cannot be
// loaded.
template <class Error>
const vdb::Module& vdb_module(const std::string& name) {
  static std::atomic<const vdb::Module*> loaded = nullptr;
  if (const vdb::Module* const module = loaded) return *module;
  const LoadingTurn turn;
  require_what_loading_takes(name);
  // Bound lazily: OpenVDB has tens of thousands of functions. Stays loaded to the end.
  void* const library = dlopen(module_path().c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const symbol = library ? dlsym(library, vdb::kModuleSymbol) : nullptr;
  if (symbol) {
    end_idle_threads(library);
    is_loaded = true;
    return *(loaded = static_cast<const vdb::Module*>(symbol));
  }
  throw Error(name + ": cannot load the module for OpenVDB, which belongs to raycone's installation: " + dlerror());
}

}  // namespace

std::unique_ptr<LatticeWriter> make_vdb_lattice_writer(OutputFile& output, const PlacedLattice& lattice,
                                                       const OutputDescription& description) {
  return vdb_module<OutputError>(output.name()).make_writer(output, lattice, description);
}

bool vdb_module_is_loaded() { return is_loaded; }

PlacedLattice read_vdb_lattice(const std::string& path, const std::string& name) {
  return vdb_module<UnreadableError>(path).read(path, name);
}

VolumeFacts read_vdb_facts(const std::string& path) { return vdb_module<UnreadableError>(path).facts(path); }

}  // namespace raycone
