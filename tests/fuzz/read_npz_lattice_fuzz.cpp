// libFuzzer target of the reader of NPZ archives for --like: whatever the bytes, it returns a lattice with samples at
// finite places, or throws InputError.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "io/fields/read_npz_lattice.h"
#include "io/files/file_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int descriptor = memfd_create("npz", 0);
  if (descriptor < 0 || write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  try {
    const raycone::Lattice lattice = raycone::read_npz_lattice("/proc/self/fd/" + std::to_string(descriptor));
    for (int axis = 0; axis < 3; ++axis) {
      if (lattice.counts[static_cast<std::size_t>(axis)] < 1 || !(lattice.spacing[axis] > 0.0)) std::abort();
      if (!std::isfinite(lattice.coordinate(axis, lattice.index_max(axis)))) std::abort();
    }
  } catch (const raycone::InputError&) {
  }
  close(descriptor);
  return 0;
}
