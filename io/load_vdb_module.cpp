// Reading and writing of OpenVDB files, by the module that is loaded when the first one is asked for.
#include <dlfcn.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <type_traits>

#include "io/child_process.h"
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

// How the child tells what became of its reading: one of these letters, and behind it the lattice or the message.
enum Outcome : char { kRead = 'r', kInvalid = 'i', kOutOfMemory = 'm' };

std::string outcome_of_reading(const vdb::Module& module, const std::string& path, const std::string& name) {
  static_assert(std::is_trivially_copyable_v<Lattice>);
  try {
    const Lattice lattice = module.read(path, name);
    return std::string(1, kRead).append(reinterpret_cast<const char*>(&lattice), sizeof lattice);
  } catch (const InputError& error) {
    return std::string(1, kInvalid) + error.what();
  } catch (const std::bad_alloc&) {
    return std::string(1, kOutOfMemory);
  }
}

Lattice lattice_from(const std::string& outcome) {
  if (outcome.at(0) == kInvalid) throw InputError(outcome.substr(1));
  if (outcome.at(0) == kOutOfMemory) throw std::bad_alloc();
  Lattice lattice;
  std::memcpy(&lattice, outcome.data() + 1, sizeof lattice);
  return lattice;
}

}  // namespace

std::unique_ptr<LatticeWriter> make_vdb_lattice_writer(OutputFile& output, const Lattice& lattice,
                                                       const OutputDescription& description) {
  return vdb_module<OutputError>(output.name()).make_writer(output, lattice, description);
}

// OpenVDB trusts what it reads: damaged files crash it, which must not be the end of this process (and its temporary
// files, and of the other meshes of a batch).
Lattice read_vdb_lattice(const std::string& path, const std::string& name) {
  const vdb::Module& module = vdb_module<InputError>(path);
  try {
    return lattice_from(in_child_process([&] { return outcome_of_reading(module, path, name); }));
  } catch (const ChildDied& death) {
    throw InputError(path + ": not a readable OpenVDB file: it crashed OpenVDB (" + death.what() + ")");
  }
}

}  // namespace raycone
