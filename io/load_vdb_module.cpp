// Reading and writing of OpenVDB files, by the module that is loaded when the first one is asked for.
#include <dlfcn.h>
#include <sys/mman.h>

#include <cstddef>
#include <filesystem>
#include <new>
#include <string>

#include "io/file_error.h"
#include "io/format_writers.h"
#include "io/read_vdb.h"
#include "io/vdb_module.h"

namespace raycone {
namespace {

// A place relative to the executable, in the build directory as in an installation, which may be moved.
std::string module_path() {
  const std::filesystem::path executable = std::filesystem::read_symlink("/proc/self/exe");
  return executable.parent_path() / RAYCONE_MODULE_FROM_EXECUTABLE / vdb::kModuleFile;
}

// Where address space is short, the libraries that OpenVDB brings fail to start their threads, which ends the process
// without a word: refuse before.
void require_address_space() {
  constexpr std::size_t kNeeded = std::size_t{192} << 20;
  void* const room = mmap(nullptr, kNeeded, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, kNeeded);
}

// `name`: the file that asks for it. Throws std::bad_alloc, and Error where the module cannot be loaded.
template <class Error>
const vdb::Module& vdb_module(const std::string& name) {
  require_address_space();
  // Bound lazily: OpenVDB has tens of thousands of functions. Stays loaded to the end.
  void* const library = dlopen(module_path().c_str(), RTLD_LAZY | RTLD_LOCAL);
  const void* const symbol = library ? dlsym(library, vdb::kModuleSymbol) : nullptr;
  if (symbol) return *static_cast<const vdb::Module*>(symbol);
  throw Error(name + ": cannot load the module for OpenVDB, which belongs to raycone's installation: " + dlerror());
}

}  // namespace

std::unique_ptr<LatticeWriter> make_vdb_lattice_writer(OutputFile& output, const Lattice& lattice,
                                                       const OutputDescription& description) {
  return vdb_module<OutputError>(output.name()).make_writer(output, lattice, description);
}

Lattice read_vdb_lattice(const std::string& path, const std::string& name) {
  return vdb_module<InputError>(path).read(path, name);
}

}  // namespace raycone
